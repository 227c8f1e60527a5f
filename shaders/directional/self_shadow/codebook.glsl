// A shadow hemisphere by patterns of its eight sectors, learnt of the cloud. Linde, Buzo & Gray 1980.
//
// Symbols: number of a sector's pattern <-> field of SELF_SHADOW_SIZE bits, from bit sector * SELF_SHADOW_SIZE on.

uvec4 codebook_pattern(uint point, int azimuth) {
    int sector = (azimuth / books_across()) & 7;
    uint number = shadow_field(point, sector * SELF_SHADOW_SIZE, SELF_SHADOW_SIZE);
    return texelFetch(self_shadow_book, ivec2(int(number), sector), 0);
}

float self_shadow_visibility(Surfel surfel, vec3 towards) {
    vec3 local = shadow_local(surfel, towards);
    vec2 place = shadow_place(local);
    float zenith = books_bit(codebook_pattern(surfel.index, 0), books_across() * self_shadow_elevations);
#if SELF_SHADOW_BLEND
    int first = int(place.y);
    uvec4 left = codebook_pattern(surfel.index, first);
    uvec4 right = codebook_pattern(surfel.index, first + 1);
    float lit = books_blend(left, right, zenith, place);
#else
    int azimuth = int(place.y + 0.5);
    float lit = books_cell(codebook_pattern(surfel.index, azimuth), zenith, int(place.x), azimuth);
#endif
    return local.z > 0.0 ? lit : 0.0;
}
