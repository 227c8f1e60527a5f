// Transfer matrices over relief: b = r G + b' S, a = b C, r = R a. Belcour 2009, section 5.2; formulas a9, errata 001-20.
// Symbols: b and a coefficients of the irradiance on ground and base, evaluated as basis_ground and basis_cloud [W m-2] by the
// slot `basis`; the matrices are multiplied before the frame, each pixel evaluates the functions (section 5.2.3).
// Deviations: the light that level planes would exchange may lie apart on a map (final gather), and the basis has the rest;
// beyond the square the light of endless planes (clouds/bounce_square.glsl).

vec3 bounce_ground(vec2 place, BounceHere here) {
    vec2 at = bounce_at(place);
    vec3 found = textureLod(bounce_ground_map, at * 0.5 + 0.5, 0.0).rgb + basis_ground(at);
    return mix(bounce_even_ground(here), found, bounce_within(at));
}

vec3 bounce_cloud(vec2 place, BounceHere here) {
    vec2 at = bounce_at(place);
    vec3 found = textureLod(bounce_cloud_map, at * 0.5 + 0.5, 0.0).rgb + basis_cloud(at);
    return mix(bounce_even_cloud(here), found, bounce_within(at));
}
