// Fourier opacity map: transmittance at any depth from a short series a texel. Jansen & Bavoil 2010, equation 8; formulas h.
// Symbols: shadow_span a texel's four sunward coordinates [m], shadow_waves_0 to _3 its a_0, a_1, b_1 ... (the pass says how); d place on
// the crossing, 0 to 1; tau = a_0 d / 2 + sum [a_k sin 2 pi k d + b_k (1 - cos 2 pi k d)] / (2 pi k); T = e^-tau, at most 1;
// shadow_window low corner and texel sides [m]; shadow_damping g weakens wave k of n by exp(-g (k / n)^2).
// Deviations: the land's shadow is apart (land_shadow.py), so that the series has leaves only, and nothing opaque rings; one of the
// four nearest texels at random, in the mean their blend: their crossings differ, so that their waves cannot be filtered.
// Does not claim: what is behind a texel's ground; between two crossings of a third one.

#include "forest/sun_map.glsl"
#include "forest/land_shadow.glsl"

vec2 map_jitter() {
    float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    return fract(noise * vec2(1.0, 5.0) + sample_shift * vec2(0.8812714616, 0.7766393890));
}

// Optical depth of one wave, whose harmonic is e = (cos, sin) of 2 pi k d.
float wave_depth(vec2 pair, vec2 e, float k) {
    float weight = exp(-shadow_damping * k * k * 4.0 / float((SHADOW_COEFFICIENTS - 1) * (SHADOW_COEFFICIENTS - 1)));
    return weight * (pair.x * e.y + pair.y * (1.0 - e.x)) / (6.283185307179586 * k);
}

float shadow_visibility(vec3 position, float h, vec2 uv) {
    vec2 line = line_of(position);
    vec2 place = (line - shadow_window.xy) / shadow_window.zw;
    vec2 size = vec2(textureSize(shadow_span, 0));
    bool outside = any(lessThan(place, vec2(0.0))) || any(greaterThan(place, size));
    vec2 nearest = clamp(floor(place + map_jitter() - 0.5), vec2(0.0), size - 1.0);
    ivec2 texel = ivec2(nearest);
    vec2 centre = shadow_window.xy + (nearest + 0.5) * shadow_window.zw;
    float sunward = dot(position, sun_direction) + dot(sunward_slope(position.xy), centre - line);
    vec4 span = texelFetch(shadow_span, texel, 0);
    float inside = clamp(span.x - sunward, 0.0, span.x - span.y) + clamp(span.z - sunward, 0.0, span.z - span.w);
    float d = inside / max(span.x - span.y + span.z - span.w, 0.1);
    vec2 e = vec2(cos(6.283185307179586 * d), sin(6.283185307179586 * d));
    vec4 waves = texelFetch(shadow_waves_0, texel, 0);
    float tau = 0.5 * waves.x * d + wave_depth(waves.yz, e, 1.0);
#if SHADOW_COEFFICIENTS > 3
    float half_way = waves.w;
    vec2 e2 = vec2(e.x * e.x - e.y * e.y, 2.0 * e.x * e.y);
    vec2 e3 = vec2(e2.x * e.x - e2.y * e.y, e2.x * e.y + e2.y * e.x);
    waves = texelFetch(shadow_waves_1, texel, 0);
    tau += wave_depth(vec2(half_way, waves.x), e2, 2.0) + wave_depth(waves.yz, e3, 3.0);
#endif
#if SHADOW_COEFFICIENTS > 7
    half_way = waves.w;
    vec2 e4 = vec2(e2.x * e2.x - e2.y * e2.y, 2.0 * e2.x * e2.y);
    vec2 e5 = vec2(e4.x * e.x - e4.y * e.y, e4.x * e.y + e4.y * e.x);
    waves = texelFetch(shadow_waves_2, texel, 0);
    tau += wave_depth(vec2(half_way, waves.x), e4, 4.0) + wave_depth(waves.yz, e5, 5.0);
#endif
#if SHADOW_COEFFICIENTS > 11
    half_way = waves.w;
    vec2 e6 = vec2(e3.x * e3.x - e3.y * e3.y, 2.0 * e3.x * e3.y);
    vec2 e7 = vec2(e6.x * e.x - e6.y * e.y, e6.x * e.y + e6.y * e.x);
    waves = texelFetch(shadow_waves_3, texel, 0);
    tau += wave_depth(vec2(half_way, waves.x), e6, 6.0) + wave_depth(waves.yz, e7, 7.0);
#endif
    float through = outside ? 1.0 : exp(-max(tau, 0.0));
    return mix(1.0, through, shadow_strength) * over_land(position);
}
