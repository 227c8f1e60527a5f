// What a ray from the sun passes on its way through the shell: a curve of how much of it is left, by the distances of eight steps.
// Symbols: near, far: distances (m) at which the share of the sun falls below SUN_NEAR and SUN_FAR; depth, optical depth gathered;
// stop, where the opaque surface is, in eighths of a texel of the sun's picture, with what is left of the sun there as a fraction;
// where other meshes receive the light, negative for where the shell ends without a surface.

const vec4 SUN_NEAR = vec4(6.993, 6.0, 5.0, 4.0) / 7.0;
const vec3 SUN_FAR = vec3(3.0, 2.0, 1.0) / 7.0;
const vec4 SUN_FIRST = log(SUN_NEAR / vec4(SUN_NEAR.yzw, SUN_FAR.x)); // depth from step to step
const vec3 SUN_LAST = log(SUN_FAR / vec3(SUN_FAR.yz, 0.5 * SUN_FAR.z));
#if THINGS == 1
const float SUN_DARK = 6.0; // depth behind which nothing is left for what stands behind the shell
#else
const float SUN_DARK = 1.95; // depth behind the last step, from where the curve goes on as it is
#endif
const float SUN_EIGHTHS = 8.0;
const float NEVER = 1.0e20;

struct SunWay {
    vec4 near;
    vec3 far;
    float stop;
    float depth;
};

const vec4 SUN_NEAR_DEPTH = -log(SUN_NEAR);
const vec3 SUN_FAR_DEPTH = -log(SUN_FAR);

// Even matter from a distance on: steps of the curve that are not passed yet are laid where it would pass them.
void sun_pass(inout SunWay way, float from, float length_of_it, float depth) {
    float slowness = length_of_it / max(depth, 1.0e-12);
    way.near = mix(way.near, from + (SUN_NEAR_DEPTH - way.depth) * slowness, greaterThanEqual(SUN_NEAR_DEPTH, vec4(way.depth)));
    way.far = mix(way.far, from + (SUN_FAR_DEPTH - way.depth) * slowness, greaterThanEqual(SUN_FAR_DEPTH, vec3(way.depth)));
    way.depth += depth;
}

// Behind all matter: steps that were not passed are nowhere.
void sun_settle(inout SunWay way) {
    way.near = mix(way.near, vec4(NEVER), greaterThan(SUN_NEAR_DEPTH, vec4(way.depth)));
    way.far = mix(way.far, vec3(NEVER), greaterThan(SUN_FAR_DEPTH, vec3(way.depth)));
}

// The opaque surface ends the way. slope: by how many texels it falls within one; the curve's next step, which is not reached,
// is laid where the curve runs through this end.
void sun_stop(inout SunWay way, float end, float slope) {
    sun_settle(way);
    way.stop = floor(SUN_EIGHTHS * (end / shadow_texel + slope)) + 0.01 + 0.98 * exp(-way.depth);
    float before = 0.0, from = way.near.x;
    for (int i = 0; i < 7 && way.near.x < NEVER; i++) {
        float level = -log(i < 4 ? SUN_NEAR[i] : SUN_FAR[i - 4]), at = i < 4 ? way.near[i] : way.far[i - 4];
        if (at >= NEVER) {
            at = from + (end - from) * (level - before) / max(way.depth - before, 1.0e-9);
            if (i < 4) way.near[i] = at; else way.far[i - 4] = at;
            break;
        }
        before = level;
        from = at;
    }
}

// Returns whether the ray met the opaque surface on its way.
bool sun_walk(Ray ray, int tet, float enter, inout SunWay way) {
    int steps = 0, face = -1, last = tet;
    float empty = 0.0; // voxels along any axis in which nothing is
    do {
        Exit exit = tet_exit(ray, tet, enter);
        Segment segment = tet_segment(ray, tet, enter, exit.t);
        float level = floor(filter_level(enter, segment.gradients) + 0.5);
        vec3 voxels = abs(segment.to - segment.from) * vec3(textureSize(shell_coded, 0)) * exp2(-level);
        float share = 1.0 / clamp(ceil(length(voxels)), 1.0, 64.0), along = max(max(voxels.x, voxels.y), max(voxels.z, 1.0e-6)) * share;
        float length_of_step = (exit.t - enter) * share, lambda = min(floor(max(empty, 0.0) / along) * share, 1.0);
        empty -= along / share;
        while (lambda < 0.999 && way.depth < SUN_DARK) {
            vec3 place = mix(segment.from, segment.to, lambda + 0.5 * share);
            Coded coded = coded_at(place, level);
            float turns = clamp(floor(coded.stride / along), 1.0, (1.0 - lambda) / share);
            float depth = filter_extinction(matter_stored(coded.number), place, level) * length_of_step * turns;
            sun_pass(way, enter + (exit.t - enter) * lambda, length_of_step * turns, depth);
            empty = coded.number > 0.0 ? 0.0 : coded.stride - (1.0 - lambda - 0.5 * share) * along / share;
            lambda += share * turns;
        }
        enter = exit.t;
        bool going = steps < 1024; // chosen, not set: see order/walk.glsl
        face = going ? exit.face : face;
        last = going ? tet : last;
        tet = tet_beyond(tet, face);
        steps++;
    } while (tet >= 0 && steps < 1024 && way.depth < SUN_DARK);
#if BASE_OPAQUE == 1
    if (tet == BEYOND_BASE) {
        float along = dot(tet_texel(last, max(face, 0)).xyz, ray.direction);
        sun_stop(way, enter, min(sqrt(max(1.0 - along * along, 0.0)) / max(along, 0.01), 8.0));
        return true;
    }
#endif
#if THINGS == 1
    way.stop = -(floor(SUN_EIGHTHS * enter / shadow_texel) + 0.01 + 0.98 * exp(-way.depth));
#endif
    return false;
}
