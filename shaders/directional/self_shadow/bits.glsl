// A point's shadow hemisphere bit by bit, each 1 where light arrives. Porquet 2005, section on self-shadowing.
//
// Symbols: (alpha, beta) <-> place, azimuth and elevation of the light in cells; f <-> bits_cell, 0 or 1.
// Deviation: between directions the four around are blended by default (`SELF_SHADOW_BLEND`), and the blend made steeper
// about its middle by self_shadow_sharpness (1), after Green 2007, which puts the edge where the blend is a half; the
// thesis does not say.

float bits_cell(uint point, int row, int azimuth) {
    int number = hemisphere_index(row, azimuth, self_shadow_azimuths, self_shadow_elevations);
    return float((shadow_word(point, number >> 5) >> uint(number & 31)) & 1u);
}

float self_shadow_visibility(Surfel surfel, vec3 towards) {
    vec3 local = shadow_local(surfel, towards);
    vec2 place = shadow_place(local);
#if SELF_SHADOW_BLEND
    // Below the middle of the lowest row it is that row.
    vec2 from = vec2(max(place.x - 0.5, 0.0), place.y);
    ivec2 first = ivec2(floor(from));
    vec2 share = from - vec2(first);
    float low = mix(bits_cell(surfel.index, first.x, first.y), bits_cell(surfel.index, first.x, first.y + 1), share.y);
    float high = mix(bits_cell(surfel.index, first.x + 1, first.y), bits_cell(surfel.index, first.x + 1, first.y + 1),
                     share.y);
    float lit = clamp(0.5 + self_shadow_sharpness * (mix(low, high, share.x) - 0.5), 0.0, 1.0);
#else
    float lit = bits_cell(surfel.index, int(place.x), int(place.y + 0.5));
#endif
    return local.z > 0.0 ? lit : 0.0;
}
