// The first sample of a picture: what fewer rays than pixels tell, laid out over all of them.
//
// Symbols: gathered_0, gathered_1: light and opacity of rays, one of each for two by two pixels: in their middle, or where there are
// two, the first through the top-left pixel and the second through the one across. Rows are counted from the bottom in them, pixels
// from the top. All is premultiplied, so that light and opacity are smoothed by the same weights and edges stay unfringed.
// Later samples have a ray for each pixel and are added as they are: the first one's share of a converged picture is 1 / n.

// Share of the four rays across the corners of a pixel that has its own: they lie in a bell of 0.65 px round it.
const float FIRST_ACROSS = 0.273;

// Linear between the four rays nearest to a place, which is counted in rays from the top-left corner of the first.
vec4 between_rays(sampler2D rays, vec2 place) {
    vec2 size = vec2(textureSize(rays, 0));
    return textureLod(rays, vec2(place.x, size.y - place.y) / size, 0.0);
}

// pixel: from the top-left corner of the picture, in its middle.
vec4 spread_out(vec2 pixel) {
#if FIRST_RAYS == 1
    return between_rays(gathered_0, 0.5 * pixel);
#else
    vec2 odd = mod(floor(pixel), 2.0);
    // Of the two rays of its block a pixel has the first, or the second, or lies between as many of each.
    float share = odd.x != odd.y ? 0.5 : odd.x > 0.5 ? 1.0 - FIRST_ACROSS : FIRST_ACROSS;
    return mix(between_rays(gathered_0, 0.5 * pixel + 0.25), between_rays(gathered_1, 0.5 * pixel - 0.25), share);
#endif
}
