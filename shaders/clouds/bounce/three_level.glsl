// Three mip levels of the plane opposite. Bouthors, Neyret & Lefebvre 2006, as Belcour 2009, section 5.1, tells it; formulas a7.
// Symbols: E = sum of w_k B_k, E irradiance that bounces add [W m-2], B_k mean of what the other side sends [W m-2] over the
// footprint of level k (widths H, 2H, 8H; H = bounce_half / 16 [m]), w_k = bounce_weights, differences of form factors.
// Deviations: the levels hold the sum of all bounces, made before the frame by the same three levels, so that a pixel makes the
// last half-bounce alone; the share beyond the widest footprint goes to the coarsest mean.
// Does not claim: slopes and mountains; all ground is level here.

vec3 bounce_sum(sampler3D levels, vec2 at) {
    vec2 uv = at * 0.5 + 0.5;
    return bounce_weights.x * textureLod(levels, vec3(uv, 0.5 / 3.0), 0.0).rgb
         + bounce_weights.y * textureLod(levels, vec3(uv, 1.5 / 3.0), 0.0).rgb
         + bounce_weights.z * textureLod(levels, vec3(uv, 2.5 / 3.0), 0.0).rgb;
}

vec3 bounce_ground(vec2 place, BounceHere here) {
    vec2 at = bounce_at(place);
    return mix(bounce_even_ground(here), bounce_sum(bounce_ground_map, at), bounce_within(at));
}

vec3 bounce_cloud(vec2 place, BounceHere here) {
    vec2 at = bounce_at(place);
    return mix(bounce_even_cloud(here), bounce_sum(bounce_cloud_map, at), bounce_within(at));
}
