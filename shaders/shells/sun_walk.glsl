// What a ray from the sun passes on its way through the shell: distances at which its optical depth passes four levels.
// Symbols: depth, optical depth gathered so far; nodes, distances (m) at which it passes SUN_LEVELS, never where it does not.

const vec4 SUN_LEVELS = vec4(0.05, 0.5, 1.5, 5.0);
const float NEVER = 1.0e20;

struct SunWay {
    vec4 nodes;
    float depth;
    float end; // m, where the last matter was
};

void sun_pass(inout SunWay way, float from, float to, float depth) {
    vec4 share = clamp((SUN_LEVELS - way.depth) / max(depth, 1.0e-12), 0.0, 1.0);
    vec4 reached = step(SUN_LEVELS, vec4(way.depth + depth)) * step(vec4(NEVER), way.nodes);
    way.nodes = mix(way.nodes, mix(vec4(from), vec4(to), share), reached);
    way.end = depth > 1.0e-6 ? to : way.end;
    way.depth += depth;
}

// Nothing of the sun is left from a distance on.
void sun_stop(inout SunWay way, float at) {
    way.nodes = min(way.nodes, vec4(at));
    way.depth = max(way.depth, SUN_LEVELS.w);
    way.end = at;
}

// Returns whether the ray met the opaque surface on its way.
bool sun_walk(Ray ray, int tet, float enter, inout SunWay way) {
    int steps = 0;
    do {
        Exit exit = tet_exit(ray, tet, enter);
        Segment segment = tet_segment(ray, tet, enter, exit.t);
        float level = filter_level(enter, segment.gradients);
        vec3 voxels = (segment.to - segment.from) * vec3(textureSize(shell_matter, 0)) * exp2(-level);
        float share = 1.0 / clamp(ceil(length(voxels)), 1.0, 64.0);
        float length_of_step = (exit.t - enter) * share, lambda = 0.0;
        do {
            float depth = matter_extinction(mix(segment.from, segment.to, lambda + 0.5 * share), level) * length_of_step;
            float from = mix(enter, exit.t, lambda);
            sun_pass(way, from, from + length_of_step, depth);
            lambda += share;
        } while (lambda < 0.999 && way.depth < SUN_LEVELS.w);
        enter = exit.t;
        tet = tet_beyond(tet, exit.face);
        steps++;
    } while (tet >= 0 && steps < 1024 && way.depth < SUN_LEVELS.w);
#if BASE_OPAQUE == 1
    if (tet == BEYOND_BASE) {
        sun_stop(way, enter);
        return true;
    }
#endif
    return false;
}
