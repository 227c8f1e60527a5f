// What a ray from the sun passes on its way through the shell: a curve of how much of it is left, by the distances of eight steps.
// Symbols: near, far: where the share of the sun falls below SUN_NEAR and SUN_FAR, whole parts of a texel; as their fractions, how much
// of the depth between the step before and this one is passed where most of the way between them is empty, 0 where none is, else from
// 0.02 to 0.98; depth, optical depth gathered; stop, where the opaque surface is, in eighths of a texel of the sun's picture, with what
// is left of the sun there as a fraction; where other meshes receive the light, negative for where the shell ends without a surface.

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
const float SUN_PARTS = 64.0;     // of a texel, in which distances are counted
const float SUN_MATTER = 1.0e-3;  // depth of a step from which on it counts as matter
const float SUN_LEAST = 0.02;     // fraction that stands for a share of 0; 0 itself says that there is no gap
const float SUN_SPAN = 0.96;
const float NOWHERE = 1.0e20;     // m
#define NEVER (2.0 * SUN_PARTS * shadow_side) // farther than the shell is wide, and few enough digits to leave some for a fraction

struct SunWay {
    vec4 near;
    vec3 far;
    float stop;
    float depth;
    float reached; // depth of the last step of the curve that was passed,
    float since;   // where,
    float gap;     // how much of the way since then was empty,
    float level;   // the sum of depth over that,
    float end;     // and where the last matter ended
};

SunWay sun_way() {
    return SunWay(vec4(NEVER), vec3(NEVER), NOWHERE, 0.0, 0.0, 0.0, 0.0, 0.0, NOWHERE);
}

const vec4 SUN_NEAR_DEPTH = -log(SUN_NEAR);
const vec3 SUN_FAR_DEPTH = -log(SUN_FAR);
const vec4 SUN_FAR_NEXT = vec4(SUN_FAR_DEPTH, 100.0); // and one that is never passed

// A depth between the step that was passed last and each of the next.
vec4 sun_fraction(SunWay way, float depth, vec4 next) {
    return SUN_LEAST + SUN_SPAN * clamp((depth - way.reached) / max(next - way.reached, 1.0e-6), 0.0, 1.0);
}

// The fraction of each of the next steps, if the way up to `from` is empty and the step lies at `to`: the gaps' mean depth.
vec4 sun_flat(SunWay way, float from, vec4 next, vec4 to) {
    float gap = way.gap + max(from - way.end, 0.0), level = way.level + max(from - way.end, 0.0) * way.depth;
    return mix(vec4(0.0), sun_fraction(way, level / max(gap, 1.0e-9), next), greaterThan(vec4(gap), 0.5 * (to - way.since)));
}

// at: m.
vec4 sun_laid(vec4 at, vec4 flat_share) {
    return floor(at * (SUN_PARTS / shadow_texel)) + flat_share;
}

// Even matter from a distance on (m): steps of the curve that are not passed yet are laid where it would pass them.
void sun_pass(inout SunWay way, float from, float length_of_it, float depth) {
    float slowness = length_of_it / max(depth, 1.0e-12), after = way.depth + depth;
    vec4 near = from + (SUN_NEAR_DEPTH - way.depth) * slowness, far = from + (SUN_FAR_NEXT - way.depth) * slowness;
    vec4 near_flat = sun_flat(way, from, SUN_NEAR_DEPTH, near), far_flat = sun_flat(way, from, SUN_FAR_NEXT, far);
    // Of steps that are passed at once the first has the gap.
    vec4 before = vec4(-1.0, SUN_NEAR_DEPTH.xyz);
    near_flat *= vec4(lessThanEqual(before, vec4(way.depth)));
    far_flat *= vec4(lessThanEqual(vec4(SUN_NEAR_DEPTH.w, SUN_FAR_DEPTH), vec4(way.depth)));
    way.near = mix(way.near, sun_laid(near, near_flat), greaterThanEqual(SUN_NEAR_DEPTH, vec4(way.depth)));
    way.far = mix(way.far, sun_laid(far, far_flat).xyz, greaterThanEqual(SUN_FAR_DEPTH, vec3(way.depth)));
    vec4 near_passed = SUN_NEAR_DEPTH * step(SUN_NEAR_DEPTH, vec4(after));
    vec3 far_passed = SUN_FAR_DEPTH * step(SUN_FAR_DEPTH, vec3(after));
    float reached = max(max(max(near_passed.x, near_passed.y), max(near_passed.z, near_passed.w)),
                        max(max(far_passed.x, far_passed.y), far_passed.z));
    bool crossed = reached > way.reached, matter = depth > SUN_MATTER;
    float gap = matter ? max(from - way.end, 0.0) : 0.0;
    way.gap = crossed ? 0.0 : way.gap + gap;
    way.level = crossed ? 0.0 : way.level + gap * way.depth;
    way.since = crossed ? from + (reached - way.depth) * slowness : way.since;
    way.end = matter ? from + length_of_it : way.end;
    way.reached = reached;
    way.depth = after;
}

// Behind all matter: steps that were not passed are nowhere, and the depth stays as it is.
void sun_settle(inout SunWay way) {
    vec4 near = NEVER + sun_fraction(way, way.depth, SUN_NEAR_DEPTH), far = NEVER + sun_fraction(way, way.depth, SUN_FAR_NEXT);
    way.near = mix(way.near, near, greaterThan(SUN_NEAR_DEPTH, vec4(way.depth)));
    way.far = mix(way.far, far.xyz, greaterThan(SUN_FAR_DEPTH, vec3(way.depth)));
}

// The opaque surface ends the way. slope: by how many texels it falls within one; steps of the curve that are not passed are laid
// where it would pass them behind this end.
void sun_stop(inout SunWay way, float end, float slope) {
    float slowness = (end - way.since) / max(way.depth - way.reached, 1.0e-6);
    vec4 near = way.since + (SUN_NEAR_DEPTH - way.reached) * slowness;
    vec4 far = way.since + (SUN_FAR_NEXT - way.reached) * slowness;
    near = min(sun_laid(near, sun_flat(way, end, SUN_NEAR_DEPTH, vec4(end))), NEVER);
    far = min(sun_laid(far, sun_flat(way, end, SUN_FAR_NEXT, vec4(end))), NEVER);
    bool begun = way.reached > 0.0;
    sun_settle(way);
    way.stop = floor(SUN_EIGHTHS * (end / shadow_texel + slope)) + 0.01 + 0.98 * exp(-way.depth);
    way.near = mix(way.near, near, lessThan(vec4(way.depth), begun ? SUN_NEAR_DEPTH : vec4(-1.0)));
    way.far = mix(way.far, far.xyz, lessThan(vec3(way.depth), begun ? SUN_FAR_DEPTH : vec3(-1.0)));
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
