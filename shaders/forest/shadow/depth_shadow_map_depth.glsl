// Depth pass of the depth shadow map. Williams 1978; Cohen 2004, section 5.1 (alpha test at 0.3).
// Symbols: pixel texel of the map, centres at half integers; shadow_window its low corner and the sides of a texel along
// shadow_right and shadow_up [m]; the result is the sunward coordinate [m] of the first matter (sun_walk.glsl).

#include "forest/sun_walk.glsl"

vec4 shadow_depth_texel(vec2 pixel) {
    vec2 line = shadow_window.xy + pixel * shadow_window.zw;
    return vec4(first_sunward(line, max(shadow_window.z, shadow_window.w), shadow_threshold));
}
