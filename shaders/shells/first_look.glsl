// The first sample of a picture: what fewer rays than pixels tell, laid out over all of them.
//
// Symbols: gathered_0, gathered_1: light and opacity of rays, one of each for two by two pixels: in their middle, or where there are
// two, the first through the top-left pixel and the second through the one across. Rows are counted from the bottom in them, pixels
// from the top. All is premultiplied, so that light and opacity are smoothed by the same weights and edges stay unfringed.
// Later samples have a ray for each pixel and are added as they are: the first one's share of a converged picture is 1 / n.

// Share of the four rays across the corners of a pixel that has its own: they lie in a bell of 0.65 px round it.
const float FIRST_ACROSS = 0.273;

// Linear between the four rays nearest to a place, which is counted in rays from the middle of the top-left one.
vec4 between_rays(sampler2D rays, vec2 place) {
    ivec2 last = textureSize(rays, 0) - 1, low = ivec2(floor(place));
    vec2 part = fract(place);
    vec4 row[2];
    for (int n = 0; n < 2; n++) {
        ivec2 left = clamp(low + ivec2(0, n), ivec2(0), last), right = clamp(low + ivec2(1, n), ivec2(0), last);
        row[n] = mix(texelFetch(rays, ivec2(left.x, last.y - left.y), 0), texelFetch(rays, ivec2(right.x, last.y - right.y), 0), part.x);
    }
    return mix(row[0], row[1], part.y);
}

// pixel: from the top-left corner of the picture, in its middle.
vec4 spread_out(vec2 pixel) {
#if FIRST_RAYS == 1
    return between_rays(gathered_0, 0.5 * pixel - 0.5);
#else
    vec2 odd = mod(floor(pixel), 2.0);
    // Of the two rays of its block a pixel has the first, or the second, or lies between as many of each.
    float share = odd.x != odd.y ? 0.5 : odd.x > 0.5 ? 1.0 - FIRST_ACROSS : FIRST_ACROSS;
    return mix(between_rays(gathered_0, 0.5 * pixel - 0.25), between_rays(gathered_1, 0.5 * pixel - 0.75), share);
#endif
}
