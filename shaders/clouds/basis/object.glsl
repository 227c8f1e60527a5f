// Indicator functions of equal blocks. Belcour 2009, section 5.2.2 (object basis).
// Symbols: a and b coefficients of the light on base and ground, a texel of basis_cloud_map and basis_ground_map each [W m-2].
// Deviations: linear between the blocks' middles, so that no block is seen.

vec3 basis_ground(vec2 at) {
    return textureLod(basis_ground_map, at * 0.5 + 0.5, 0.0).rgb;
}

vec3 basis_cloud(vec2 at) {
    return textureLod(basis_cloud_map, at * 0.5 + 0.5, 0.0).rgb;
}
