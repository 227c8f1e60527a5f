// A point's shadow hemisphere bit by bit, each 1 where light arrives. Porquet 2005, section on self-shadowing.
//
// Symbols: (alpha, beta) <-> place, azimuth and elevation of the light in cells; f <-> bits_cell, 0 or 1.
// Deviation: between directions the four around are blended by default (`SELF_SHADOW_BLEND`), and the blend made steeper
// about its middle by self_shadow_sharpness (1), after Green 2007, which puts the edge where the blend is a half; the
// thesis does not say.

float bits_cell(uvec4 words, int number) {
    return float((words[(number >> 5) & 3] >> uint(number & 31)) & 1u);
}

// Two neighbours of a row, or twice the zenith. The azimuths of a row divide 128: all of it is in one block of words.
vec2 bits_pair(uint point, int row, int azimuth) {
    int first = hemisphere_index(row, azimuth, self_shadow_azimuths, self_shadow_elevations);
    int second = hemisphere_index(row, azimuth + 1, self_shadow_azimuths, self_shadow_elevations);
    uvec4 words = shadow_words(point, first >> 7);
    return vec2(bits_cell(words, first), bits_cell(words, second));
}

float self_shadow_visibility(Surfel surfel, vec3 towards) {
    vec3 local = shadow_local(surfel, towards);
    vec2 place = shadow_place(local);
#if SELF_SHADOW_BLEND
    // Below the middle of the lowest row it is that row.
    vec2 from = vec2(max(place.x - 0.5, 0.0), place.y);
    ivec2 first = ivec2(floor(from));
    vec2 share = from - vec2(first);
    vec2 low = bits_pair(surfel.index, first.x, first.y), high = bits_pair(surfel.index, first.x + 1, first.y);
    vec2 sides = mix(low, high, share.x);
    float lit = clamp(0.5 + self_shadow_sharpness * (mix(sides.x, sides.y, share.y) - 0.5), 0.0, 1.0);
#else
    float lit = bits_pair(surfel.index, int(place.x), int(place.y + 0.5)).x;
#endif
    return local.z > 0.0 ? lit : 0.0;
}
