// Depth pass of the cascaded shadow maps: one below the other in one texture. Engel 2006; Zhang, Sun, Xu & Lun 2006.
// Symbols: pixel texel, centres at half integers; shadow_resolution texels a side of each cascade; shadow_windows low corner and
// texel sides [m] of each; the result is the sunward coordinate [m] of the first matter (sun_walk.glsl).

#include "forest/sun_walk.glsl"

vec4 shadow_depth_texel(vec2 pixel) {
    float cascade = floor(pixel.y / shadow_resolution);
    vec4 window = shadow_windows[int(cascade)];
    vec2 line = window.xy + (pixel - vec2(0.0, cascade * shadow_resolution)) * window.zw;
    return vec4(first_sunward(line, max(window.z, window.w), shadow_threshold));
}
