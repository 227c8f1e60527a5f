// How much of the sun is left at each depth, from a map that keeps a curve a texel. Lokovic and Veach 2000, "Deep Shadow Maps".
//
// Symbols: nodes, distances from the sun's side (m) at which the optical depth passes SUN_LEVELS; rest, the whole depth and where it
// ends (m). Deviations: four nodes at given depths stand for the paper's curve of any number of nodes; one texel is read, at a place
// that differs from sample to sample, whose mean over samples is the filter.

float shadow_visibility(vec3 point) {
    vec3 from = point - shadow_origin;
    float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    vec2 jitter = fract(vec2(noise, 7.0 * noise) + sample_shift * vec2(0.7548776662, 0.5698402910)) - 0.5;
    vec2 place = vec2(dot(from, shadow_across), dot(from, shadow_down)) + shadow_softness * jitter;
    ivec2 texel = clamp(ivec2(place.x, shadow_side - place.y), ivec2(0), ivec2(shadow_side) - 1);
    float t = dot(from, shadow_along) - shadow_bias * shadow_texel;
    vec4 nodes = texelFetch(shadow_nodes, texel, 0);
    vec2 rest = texelFetch(shadow_rest, texel, 0).xy;
    // The curve: nothing before the first node, straight between nodes, level after the end.
    float number = dot(step(nodes, vec4(t)), vec4(1.0)); // nodes passed
    float from_depth = number < 0.5 ? 0.0 : number < 1.5 ? SUN_LEVELS.x : number < 2.5 ? SUN_LEVELS.y : SUN_LEVELS.z;
    float to_depth = number < 0.5 ? 0.0 : number < 1.5 ? SUN_LEVELS.y : number < 2.5 ? SUN_LEVELS.z : SUN_LEVELS.w;
    float from_t = number < 1.5 ? nodes.x : number < 2.5 ? nodes.y : nodes.z;
    float to_t = number < 1.5 ? nodes.y : number < 2.5 ? nodes.z : nodes.w;
    bool last = to_t >= NEVER;
    to_depth = last ? max(rest.x, from_depth) : to_depth;
    to_t = last ? max(rest.y, from_t) : to_t;
    float share = clamp((t - from_t) / max(to_t - from_t, 1.0e-9), 0.0, 1.0);
    float depth = number > 3.5 ? 1.0e3 : mix(from_depth, to_depth, share);
    return exp(-depth);
}
