// Cells of constant solid angle. Belcour 2009, section 5.2.2 and figure 5.10.
// Symbols: a and b coefficients of the light on base and ground, a texel of basis_cloud_map and basis_ground_map each [W m-2];
// basis_parts number of the cell at each place of the square.
// Deviations: cells are put together of squares of half a cloud height; what the square's corners have beyond the last ring
// belongs to its cells.

int basis_part(vec2 at) {
    ivec2 size = textureSize(basis_parts, 0);
    ivec2 place = clamp(ivec2((at * 0.5 + 0.5) * vec2(size)), ivec2(0), size - 1);
    return int(texelFetch(basis_parts, place, 0).r + 0.5);
}

vec3 basis_ground(vec2 at) {
    return texelFetch(basis_ground_map, ivec2(basis_part(at), 0), 0).rgb;
}

vec3 basis_cloud(vec2 at) {
    return texelFetch(basis_cloud_map, ivec2(basis_part(at), 0), 0).rgb;
}
