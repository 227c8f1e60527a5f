// Haar wavelets summed at a place. Belcour 2009, section 5.2.2 and 5.2.3 (evaluation in the pixel's shader); Haar 1910.
// Symbols: a and b coefficients of the light on base and ground; basis_cloud_map and basis_ground_map hold a_i phi_i and b_i phi_i
// [W m-2] where phi_i is positive first, level by level: 2^l squares along a side at level l, three wavelets each.
// Deviations: all 1,024 wavelets are laid out, those that are not kept as 0: a place is in 16 of them.

const int BASIS_LEVELS = 5;

vec3 basis_sum(sampler2D heights, vec2 at) {
    vec2 uv = clamp(at * 0.5 + 0.5, 0.0, 0.999999);
    vec3 found = texelFetch(heights, ivec2(0, (1 << BASIS_LEVELS) - 1), 0).rgb;
    for (int level = 0; level < BASIS_LEVELS; level++) {
        int count = 1 << level;
        vec2 place = uv * float(count);
        ivec2 square = ivec2(place);
        vec2 turn = 1.0 - 2.0 * step(0.5, place - vec2(square));
        ivec2 texel = ivec2(3 * square.x, count - 1 + square.y);
        found += turn.y * texelFetch(heights, texel, 0).rgb;
        found += turn.x * texelFetch(heights, texel + ivec2(1, 0), 0).rgb;
        found += turn.x * turn.y * texelFetch(heights, texel + ivec2(2, 0), 0).rgb;
    }
    return found;
}

vec3 basis_ground(vec2 at) {
    return basis_sum(basis_ground_map, at);
}

vec3 basis_cloud(vec2 at) {
    return basis_sum(basis_cloud_map, at);
}
