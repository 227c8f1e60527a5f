// Exact exchange of two level planes: E(x) = integral of B(y) H^2 / (pi (H^2 + |x - y|^2)^2) dy, Sillion & Puech 1989 (form factors),
// summed before the frame by fast Fourier transforms, Cooley & Tukey 1965; formulas a7.
// Symbols: E irradiance that bounces add, bounce_ground and bounce_cloud [W m-2]; H bounce_half / 16 [m].
// Deviations: cells of half a height; beyond the square the light of endless planes (clouds/bounce_square.glsl).
// Does not claim: slopes and mountains; all ground is level here.

vec3 bounce_ground(vec2 place, BounceHere here) {
    vec2 at = bounce_at(place);
    return mix(bounce_even_ground(here), textureLod(bounce_ground_map, at * 0.5 + 0.5, 0.0).rgb, bounce_within(at));
}

vec3 bounce_cloud(vec2 place, BounceHere here) {
    vec2 at = bounce_at(place);
    return mix(bounce_even_cloud(here), textureLod(bounce_cloud_map, at * 0.5 + 0.5, 0.0).rgb, bounce_within(at));
}
