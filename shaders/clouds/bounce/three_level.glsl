// Three mip levels of the plane opposite. Bouthors, Neyret & Lefebvre 2006, as Belcour 2009, section 5.1, tells it; formulas a7.
// Symbols: E = sum of w_k B_k, E irradiance that bounces add [W m-2], B_k mean of what the other side sends [W m-2] over the
// footprint of level k (widths H, 2H, 8H; H = bounce_half / 16 [m]), w_k = bounce_weights, differences of form factors.
// Deviations: the levels hold the sum of all bounces, made before the frame by the same three levels, so that a pixel makes the
// last half-bounce alone; the share beyond the widest footprint goes to the coarsest mean.
// Does not claim: slopes and mountains; all ground is level here.

// The levels stand above each other; what is read lies off their edges (bounce_within).
vec3 bounce_sum(sampler2D levels, vec2 at) {
    vec2 uv = clamp(at, -0.97, 0.97) * 0.5 + 0.5;
    uv.y /= 3.0;
    return bounce_weights.x * textureLod(levels, uv, 0.0).rgb
         + bounce_weights.y * textureLod(levels, uv + vec2(0.0, 1.0 / 3.0), 0.0).rgb
         + bounce_weights.z * textureLod(levels, uv + vec2(0.0, 2.0 / 3.0), 0.0).rgb;
}

vec3 bounce_ground(vec2 place, BounceHere here) {
    vec2 at = bounce_at(place);
    return mix(bounce_even_ground(here), bounce_sum(bounce_ground_map, at), bounce_within(at));
}

vec3 bounce_cloud(vec2 place, BounceHere here) {
    vec2 at = bounce_at(place);
    return mix(bounce_even_cloud(here), bounce_sum(bounce_cloud_map, at), bounce_within(at));
}
