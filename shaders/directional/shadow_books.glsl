// Sectors of a shadow hemisphere by the number of a pattern in a book (Linde, Buzo & Gray 1980).
//
// Symbols: self_shadow_book, row sector, column number: a pattern's bits, cell (row, turn) at row * across + turn, across
// being an eighth of the azimuths; behind the cells of the first sector, the zenith.
// renderer/directional/codes/codebook.py has the twin.

int books_across() {
    return self_shadow_azimuths / 8;
}

float books_bit(uvec4 pattern, int number) {
    return float((pattern[number >> 5] >> uint(number & 31)) & 1u);
}

float books_cell(uvec4 pattern, float zenith, int row, int azimuth) {
    int across = books_across();
    float lit = books_bit(pattern, min(row, self_shadow_elevations - 1) * across + azimuth % across);
    return row >= self_shadow_elevations ? zenith : lit;
}

// Of the two patterns that hold the azimuths on either side of a place, and the zenith.
float books_blend(uvec4 left, uvec4 right, float zenith, vec2 place) {
    vec2 from = vec2(max(place.x - 0.5, 0.0), place.y);
    ivec2 first = ivec2(floor(from));
    vec2 share = from - vec2(first);
    vec2 low = vec2(books_cell(left, zenith, first.x, first.y), books_cell(right, zenith, first.x, first.y + 1));
    vec2 high = vec2(books_cell(left, zenith, first.x + 1, first.y), books_cell(right, zenith, first.x + 1, first.y + 1));
    vec2 lit = mix(low, high, share.x);
    return mix(lit.x, lit.y, share.y);
}
