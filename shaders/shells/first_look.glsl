// The first sample of a picture: what fewer rays than pixels tell, laid out over all of them.
//
// Symbols: gathered: light and opacity of rays: one between two by two pixels each; or one through every second pixel, as the white
// squares of a chessboard, in rows that slant by a pixel from row to row and begin first_before columns before the picture. Rows are
// counted from the bottom in it, pixels from the top. All is premultiplied, so that light and opacity are smoothed by the same weights
// and edges stay unfringed. Later samples have a ray for each pixel and are added as they are: the first one's share of a converged
// picture is 1 / n.

// Share of the four rays across the corners of a pixel that has its own: they lie in a bell of 0.65 px round it.
const float FIRST_ACROSS = 0.273;

#if FIRST_RAYS == 1
// pixel: from the top-left corner of the picture, in its middle.
vec4 spread_out(vec2 pixel) {
    vec2 size = vec2(textureSize(gathered, 0)), place = 0.5 * pixel;
    return textureLod(gathered, vec2(place.x, size.y - place.y) / size, 0.0);
}
#else
// Of a white square; beyond the picture's rim, of the one inside that lies opposite.
vec4 ray_through(ivec2 square) {
    ivec2 last = ivec2(picture_size) - 1;
    square = last - abs(last - abs(square));
    return texelFetch(gathered, ivec2((square.x - square.y) / 2 + first_before, textureSize(gathered, 0).y - 1 - square.y), 0);
}

vec4 spread_out(vec2 pixel) {
    ivec2 here = ivec2(floor(pixel));
    bool white = (here.x + here.y) % 2 == 0;
    // Neighbours of a black square across its sides, of a white one across its corners.
    ivec2 next = white ? ivec2(1, 1) : ivec2(1, 0), turned = white ? ivec2(1, -1) : ivec2(0, 1);
    vec4 round = ray_through(here + next) + ray_through(here - next) + ray_through(here + turned) + ray_through(here - turned);
    vec4 own = ray_through(white ? here : here + next);
    return mix(own, 0.25 * round, white ? FIRST_ACROSS : 1.0);
}
#endif
