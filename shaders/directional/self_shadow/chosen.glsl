// A ring of horizons or one of three sets of patterns, as each point's code says. Max 1988; Linde, Buzo & Gray 1980.
//
// Symbols: choice <-> bits 70 and 71: 0 the ring, else a set of books, whose sectors have 9 bits, the last two 8.
// renderer/directional/codes/chosen.py has the twin and the layout.

uvec4 chosen_pattern(uint point, int choice, int azimuth) {
    int sector = (azimuth / books_across()) & 7;
    uint number = shadow_field(point, 9 * sector - max(sector - 6, 0), sector < 6 ? 9 : 8);
    return texelFetch(self_shadow_book, ivec2(int(number), 8 * max(choice - 1, 0) + sector), 0);
}

float self_shadow_visibility(Surfel surfel, vec3 towards) {
    vec3 local = shadow_local(surfel, towards);
    vec2 place = shadow_place(local);
    int choice = int(shadow_field(surfel.index, 70, 2));
    float zenith = books_bit(chosen_pattern(surfel.index, choice, 0), books_across() * self_shadow_elevations);
#if SELF_SHADOW_BLEND
    int first = int(place.y);
    uvec4 left = chosen_pattern(surfel.index, choice, first);
    uvec4 right = chosen_pattern(surfel.index, choice, first + 1);
    float lit = books_blend(left, right, zenith, place);
#else
    int azimuth = int(place.y + 0.5);
    float lit = books_cell(chosen_pattern(surfel.index, choice, azimuth), zenith, int(place.x), azimuth);
#endif
    lit = choice == 0 ? ring_visibility(surfel.index, place, 16) : lit;
    return local.z > 0.0 ? lit : 0.0;
}
