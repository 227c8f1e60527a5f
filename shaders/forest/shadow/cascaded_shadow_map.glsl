// Cascaded shadow maps. Engel 2006; Zhang, Sun, Xu & Lun 2006 (parallel-split maps); Valient 2007 (snapped texels).
// Symbols: shadow_windows of each cascade, the nearest first: low corner and texel sides [m] along shadow_right and shadow_up;
// shadow_bias [m], shadow_texel_bias for each metre of a texel's width; shadow_fade length [m] over which light is lost behind the
// first matter (Dachsbacher & Stamminger 2003); SHADOW_FILTERED whether four texels are blended (Reeves, Salesin & Cook 1987).
// Deviation: a point takes the finest cascade whose window holds it, which may be finer than that of its distance.
// Knows one depth per texel. Between two cascades the texels' width jumps.

#include "forest/sun_map.glsl"

float cascade_lit(ivec2 texel, float cascade, vec4 window, vec2 line, float sunward, vec2 slope, float bias) {
    int side = textureSize(shadow_depth, 0).x;
    vec2 centre = window.xy + (vec2(texel) + 0.5) * window.zw;
    float first = texelFetch(shadow_depth, texel + ivec2(0, int(cascade) * side), 0).r;
    return past_first(first, sunward + dot(slope, centre - line), bias, shadow_fade);
}

float shadow_visibility(vec3 position, float h, vec2 uv) {
    vec2 line = line_of(position);
    float side = float(textureSize(shadow_depth, 0).x);
    float cascade = -1.0;
    vec4 window = shadow_windows[0];
    for (int k = SHADOW_CASCADES - 1; k >= 0; k--) {
        vec2 place = (line - shadow_windows[k].xy) / shadow_windows[k].zw;
        bool holds = all(greaterThan(place, vec2(0.5))) && all(lessThan(place, vec2(side - 0.5)));
        cascade = holds ? float(k) : cascade;
        window = holds ? shadow_windows[k] : window;
    }
    vec2 place = clamp((line - window.xy) / window.zw, 0.5, side - 0.5);
    float sunward = dot(position, sun_direction);
    vec2 slope = sunward_slope(position.xy);
    float bias = shadow_bias + shadow_texel_bias * max(window.z, window.w);
    float layer = max(cascade, 0.0);
#if SHADOW_FILTERED
    vec2 low = min(floor(place - 0.5), side - 2.0);
    vec2 f = place - 0.5 - low;
    ivec2 at = ivec2(low);
    vec2 south = vec2(cascade_lit(at, layer, window, line, sunward, slope, bias),
                      cascade_lit(at + ivec2(1, 0), layer, window, line, sunward, slope, bias));
    vec2 north = vec2(cascade_lit(at + ivec2(0, 1), layer, window, line, sunward, slope, bias),
                      cascade_lit(at + 1, layer, window, line, sunward, slope, bias));
    vec2 both = mix(south, north, f.y);
    float lit = mix(both.x, both.y, f.x);
#else
    float lit = cascade_lit(ivec2(floor(place)), layer, window, line, sunward, slope, bias);
#endif
    return sun_direction.z < 0.0 ? 0.0 : mix(1.0, cascade < 0.0 ? 1.0 : lit, shadow_strength);
}
