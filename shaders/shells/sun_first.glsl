// Where a ray from the sun has passed a given optical depth, or meets the opaque surface.
// Symbols: passed, optical depth gathered; depth, where it reaches `most` (m). Returns whether it did, or met the surface.

bool sun_first(Ray ray, int tet, float enter, float most, inout float passed, inout float depth) {
    int steps = 0;
    do {
        Exit exit = tet_exit(ray, tet, enter);
        Segment segment = tet_segment(ray, tet, enter, exit.t);
        float level = filter_level(enter, segment.gradients);
        vec3 voxels = (segment.to - segment.from) * vec3(textureSize(shell_matter, 0)) * exp2(-level);
        float share = 1.0 / clamp(ceil(length(voxels)), 1.0, 64.0), lambda = 0.0;
        do {
            float more = matter_extinction(mix(segment.from, segment.to, lambda + 0.5 * share), level) * (exit.t - enter) * share;
            float at = mix(enter, exit.t, lambda + share * clamp((most - passed) / max(more, 1.0e-9), 0.0, 1.0));
            depth = passed < most && passed + more >= most ? at : depth;
            passed += more;
            lambda += share;
        } while (lambda < 0.999 && passed < most);
        enter = exit.t;
        tet = tet_beyond(tet, exit.face);
        steps++;
    } while (tet >= 0 && steps < 1024 && passed < most);
    bool surface = BASE_OPAQUE == 1 && tet == BEYOND_BASE && passed < most;
    depth = surface ? enter : depth;
    return surface || passed >= most;
}
