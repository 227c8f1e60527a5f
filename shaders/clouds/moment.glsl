// The thickness map of a moment, where it is drawn: the twin of `thickness_map` in renderer/clouds/cloud_map.py.
//
// Cahalan and Snider 1989 (spectrum of the fields). Symbols: fields A and B, of mean 0 and variance 1; turn (cos, sin) of the
// moment's angle, f = A cos + B sin; threshold above which f lies over the clouds' cover; EDGE, SWELLS deviations of f over which
// a cloud gains its thickness and beyond which it grows no thicker.

float moment_thickness(vec2 fields) {
    float field = dot(fields, moment_turn), above = (field - moment_threshold) / EDGE;
    float rise = sign(above) * (1.0 - exp(-abs(above)));
    float swell = SWELLS * tanh(field / SWELLS);
    return rise * exp(moment_variation * swell - 0.5 * moment_variation * moment_variation);
}

// Thickness, what it changes per metre to the east and to the north, and what of it is above zero.
vec4 moment_with_slopes(sampler2D heights, ivec2 at) {
    ivec2 last = textureSize(heights, 0) - 1; // sides are powers of two: & wraps round the edge
    float here = texelFetch(heights, at, 0).r;
    float east = max(texelFetch(heights, ivec2(at.x + 1, at.y) & last, 0).r, 0.0);
    float west = max(texelFetch(heights, ivec2(at.x - 1, at.y) & last, 0).r, 0.0);
    float north = max(texelFetch(heights, ivec2(at.x, at.y + 1) & last, 0).r, 0.0);
    float south = max(texelFetch(heights, ivec2(at.x, at.y - 1) & last, 0).r, 0.0);
    return vec4(here, vec2(east - west, north - south) / (2.0 * moment_texel), max(here, 0.0));
}
