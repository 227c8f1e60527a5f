// Fields of a point's shadow code, and where a direction of light lies in its hemisphere.
//
// Porquet 2005, section on self-shadowing; renderer/directional/codes has the twins. `shadow_words(point, block)` gives
// four words of a point. self_shadow_azimuths, self_shadow_elevations: the layout of the masks.

uint shadow_word(uint point, int number) {
    return shadow_words(point, number >> 2)[number & 3];
}

// Bits of a code from a bit on, of which a word may hold the first alone.
uint shadow_field(uint point, int offset, int width) {
    int shift = offset & 31;
    uint low = shadow_word(point, offset >> 5) >> shift;
    // A shift by 32 has no defined result.
    uint high = shift == 0 ? 0u : shadow_word(point, (offset + width - 1) >> 5) << (32 - shift);
    return (low | high) & ((1u << width) - 1u);
}

// A direction in the axes of a point: along tangent, bitangent and normal.
vec3 shadow_local(Surfel surfel, vec3 towards) {
    return vec3(dot(towards, surfel.tangent), dot(towards, surfel.bitangent), dot(towards, surfel.normal));
}

// Steps above the horizon, and parts of a row from the tangent.
vec2 shadow_place(vec3 local) {
    return hemisphere_place(local, self_shadow_azimuths, self_shadow_elevations);
}

// From 0 in the middle of the last row to 1 at the edge of the zenith's cell.
float shadow_zenith(vec2 place) {
    return clamp(2.0 * (place.x - float(self_shadow_elevations) + 0.5), 0.0, 1.0);
}
