// Depth pass of the perspective shadow map. Stamminger & Drettakis 2002, section 3.
// Symbols: pixel texel, centres at half integers; shadow_to_light homography from the map, [0, 1], to the plane across the light, from
// shadow_anchor [m]; the result is the sunward coordinate [m] of the first matter (sun_walk.glsl).

#include "forest/sun_walk.glsl"

vec2 perspective_line(vec2 pixel) {
    vec3 line = shadow_to_light * vec3(pixel / shadow_resolution, 1.0);
    return line.xy / line.z;
}

vec4 shadow_depth_texel(vec2 pixel) {
    vec2 line = perspective_line(pixel);
    float texel = max(length(perspective_line(pixel + vec2(1.0, 0.0)) - line), length(perspective_line(pixel + vec2(0.0, 1.0)) - line));
    return vec4(first_sunward(line + shadow_anchor, texel, shadow_threshold));
}
