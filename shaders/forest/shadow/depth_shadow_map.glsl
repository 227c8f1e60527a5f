// Depth shadow map. Williams 1978; Cohen 2004, section 5.1; snapping of its texels: Valient 2007.
// Symbols: shadow_window low corner and texel sides [m] of the map along shadow_right and shadow_up; shadow_bias [m], and
// shadow_texel_bias for each metre of a texel's width; SHADOW_FILTERED whether four comparisons are blended (Reeves et al. 1987).
// Knows one depth per texel: nothing of transparency. Its texels move when the sun does: it scintillates, and that is its failure.

#include "forest/sun_map.glsl"

float depth_map_lit(ivec2 texel, vec2 line, float sunward, vec2 slope, float bias) {
    vec2 centre = shadow_window.xy + (vec2(texel) + 0.5) * shadow_window.zw;
    float first = texelFetch(shadow_depth, clamp(texel, ivec2(0), textureSize(shadow_depth, 0) - 1), 0).r;
    return past_first(first, sunward + dot(slope, centre - line), bias, 0.0);
}

float shadow_visibility(vec3 position, float h, vec2 uv) {
    vec2 line = line_of(position);
    vec2 place = (line - shadow_window.xy) / shadow_window.zw;
    float sunward = dot(position, sun_direction);
    vec2 slope = sunward_slope(position.xy);
    float bias = shadow_bias + shadow_texel_bias * max(shadow_window.z, shadow_window.w);
#if SHADOW_FILTERED
    vec2 low = floor(place - 0.5);
    vec2 f = place - 0.5 - low;
    ivec2 at = ivec2(low);
    vec2 south = vec2(depth_map_lit(at, line, sunward, slope, bias), depth_map_lit(at + ivec2(1, 0), line, sunward, slope, bias));
    vec2 north = vec2(depth_map_lit(at + ivec2(0, 1), line, sunward, slope, bias), depth_map_lit(at + 1, line, sunward, slope, bias));
    vec2 both = mix(south, north, f.y);
    float lit = mix(both.x, both.y, f.x);
#else
    float lit = depth_map_lit(ivec2(floor(place)), line, sunward, slope, bias);
#endif
    vec2 size = vec2(textureSize(shadow_depth, 0));
    bool outside = any(lessThan(place, vec2(0.0))) || any(greaterThan(place, size));
    return sun_direction.z < 0.0 ? 0.0 : mix(1.0, outside ? 1.0 : lit, shadow_strength);
}
