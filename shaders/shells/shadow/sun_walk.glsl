// From every place that is lit a ray walks to the sun through the shell's cells, two samples a voxel; where it leaves them, the deep
// shadow map tells what other parts of the shell have left. After Kajiya and Von Herzen 1984, "Ray tracing volume densities".
//
// Symbols: the paper's optical depth between a place and the light <-> depth [-]; rho <-> matter_extinction [1/m]; tet, cell of the ray.
// Pictures whose order does not tell the cell have the map alone.

const float SHADOW_DARK = 9.0; // depth behind which nothing is left

float shadow_visibility(vec3 point) {
    Ray ray = Ray(point, sun_direction);
    int tet = tet_here, steps = 0;
    float enter = 0.0, depth = 0.0, away = length(point - camera_origin);
    vec3 shares = way_shares; // of the ray that is lit, which goes on afterwards
    while (tet >= 0 && steps < 1024 && depth < SHADOW_DARK) {
        Exit exit = tet_exit(ray, tet, enter);
        Segment segment = tet_segment(ray, tet, enter, exit.t);
        float level = filter_level(away, segment.gradients);
        vec3 voxels = (segment.to - segment.from) * vec3(textureSize(shell_matter, 0)) * exp2(-level);
        float share = 1.0 / clamp(ceil(shadow_rate * length(voxels)), 1.0, 256.0), lambda = 0.5 * share;
        do {
            depth += matter_extinction(mix(segment.from, segment.to, lambda), level) * (exit.t - enter) * share;
            lambda += share;
        } while (lambda < 1.0);
        enter = exit.t;
        tet = tet_beyond(tet, exit.face);
        steps++;
    }
    way_shares = shares;
#if BASE_OPAQUE == 1
    if (tet == BEYOND_BASE) return 0.0;
#endif
    // A little farther, so that texels' slanting edges do not count the way twice.
    vec3 beyond = point + (enter + shadow_bias * shadow_texel) * sun_direction;
    return tet_here < 0 ? deep_share(point, shadow_bias * shadow_texel, shadow_softness)
                        : exp(-depth) * deep_share(beyond, 0.0, shadow_softness);
}
