// How much of the sun a map from its side leaves at a place: the curve of one texel.
//
// Symbols: near, far: where the share that is left falls below SUN_NEAR and SUN_FAR, as in sun_walk.glsl, the optical depth straight
// between them and beyond the last, or even where most of the way is empty; surface, how far a place is behind the opaque surface, on
// which it lies where that is no more than `slack` either way (m); softness, width over which texels are read (texels).

float deep_share(vec3 point, float slack, float softness) {
    vec3 from = point - shadow_origin;
    float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    vec2 jitter = fract(vec2(noise, 7.0 * noise) + sample_shift * vec2(0.7548776662, 0.5698402910)) - 0.5;
    // A first sample takes the nearest: its noise would be more than its stairs are off.
    vec2 place = vec2(dot(from, shadow_across), dot(from, shadow_down)) + (sample_shift > 0.0 ? softness : 0.0) * jitter;
    ivec2 texel = clamp(ivec2(place.x, shadow_side - place.y), ivec2(0), ivec2(shadow_side) - 1);
    vec4 near = texelFetch(shadow_near, texel, 0), far = texelFetch(shadow_far, texel, 0);
    float t = dot(from, shadow_along), parts = t * (SUN_PARTS / shadow_texel);
    vec4 near_at = floor(near);
    vec3 far_at = floor(far.xyz);
    vec4 first = clamp((parts - near_at) / max(vec4(near_at.yzw, far_at.x) - near_at, 1.0), 0.0, 1.0);
    vec3 last = max((parts - far_at) / max(vec3(far_at.yz, 2.0 * far_at.z - far_at.y) - far_at, 1.0), 0.0);
    last.xy = min(last.xy, 1.0);
    // Between two steps most of the way may be empty: then the depth there is the same everywhere.
    vec4 first_flat = (vec4(near.yzw, far.x) - vec4(near_at.yzw, far_at.x) - SUN_LEAST) / SUN_SPAN;
    vec2 last_flat = (far.yz - far_at.yz - SUN_LEAST) / SUN_SPAN;
    first = mix(first, first_flat, greaterThan(min(first * (1.0 - first), first_flat + 0.01), vec4(0.0)));
    last.xy = mix(last.xy, last_flat, greaterThan(min(last.xy * (1.0 - last.xy), last_flat + 0.01), vec2(0.0)));
    float depth = dot(first, SUN_FIRST) + dot(last, SUN_LAST);
#if THINGS == 1
    float left = (fract(-far.w) - 0.01) / 0.98;
    if (far.w < 0.0) return t < floor(-far.w) * shadow_texel / SUN_EIGHTHS ? exp(-depth) : left;
#endif
    float surface = t - floor(far.w) * shadow_texel / SUN_EIGHTHS;
    float at_surface = abs(surface) <= slack ? (fract(far.w) - 0.01) / 0.98 : 0.0;
    return surface < -slack ? exp(-depth) : at_surface;
}
