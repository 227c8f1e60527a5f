// Ray marching of the canopy layer, front to back, with early stop and empty-space skipping.
// Levoy 1990 (early stop, empty space); formulas (g). Today's way beside the thesis' slices.
// Symbols: alpha opacity for one voxel's length; ds step [m]; tau optical depth of a step, in powers of two, as all depths here;
// climb rise over the ground, metre per metre of the ray.
// Deviations: the step grows with the mip level, but across STEP_LAYERS layers at most, for it stands for them all; light is evaluated
// at one random depth (events.glsl), not at every step; each ray reads nearest voxels at its own offset, whose mean over
// rays is trilinear interpolation.

// Layers of voxels that a step may cross, in its own measure.
const float STEP_LAYERS = 6.0;

// Steps by which light may be looked at behind the end of its own: where an early stop leaves the rest of the way untrodden.
const float BEYOND = 2.0;

// At the finest level crowns have sides: in the step where a ray enters one, matter begins anywhere before the sample, as far in
// front of it in the mean as an even step has it behind its own beginning. Half the way is right in the mean.
const float SHARP = 0.5;

// Farthest [m] that a tree's voxels lie from its foot: 8 m along either axis.
const float CROWN_REACH = 11.4;

// In a smoothed first sample, steps grow by TIRED each from the EVEN-th on, to half as long again: few rays go that far, but every
// one of a block of pixels waits for its last.
const float EVEN = 16.0;
const float TIRED = 0.1;

// Longest step [voxels of the finest level] that a first sample's longer steps come to: coarser levels have long ones anyway.
const float LENGTHENED = 4.0;

// Length of a step at a level [m].
float step_at(float scale, float climb) {
    float even = geometry_step * min(scale, max(STEP_LAYERS / max(abs(climb), 1e-3), 1.0));
    float first = sample_shift == 0.0 ? min(geometry_first * geometry_step, LENGTHENED) : 0.0;
    return voxel_size * max(even, first);
}

// Formulas g: T = 2^-(sum of tau), tau = -log2(1 - alpha) ds / voxel. A sample stands for the step around it, which begins jitter.x of
// itself before; light is looked at where in the step the depth is passed, as if its matter were spread evenly (Beer and Lambert).
void geometry_trace(vec3 origin, vec3 direction, float t, vec4 jitter, inout Event event) {
    float rate = voxel_rate(direction);
    vec3 offset = voxel_offset(jitter);
    float wanted = -log2(1.0 - event.xi);
    float closed = -log2(max(geometry_stop, 1e-6));
    // A ray that comes down to the lowest land in reach is opaque in the end: once it has its place, nothing more is asked of it.
    bool ends = origin.z + scene_reach * direction.z < 0.0;
    float grows = sample_smoothed > 0.0 ? TIRED : 0.0;
    float depth = 0.0;
    float previous = t;
    float before = origin.z + t * direction.z - ground_height(origin.xy + t * direction.xy);
    float above = before;
    t += step_at(exp2(level_at(t, jitter.z)), direction.z) * jitter.x;
    int found = 1;
    for (int i = 0; i < MARCH_STEPS && found == 1; i++) {
        float level = level_at(t, jitter.z);
        float scale = exp2(level);
        vec3 p = origin + t * direction;
        vec3 ground = ground_at(p.xy);
        float climb = direction.z - dot(ground.yz, direction.xy);
        float ds = step_at(scale, climb) * (1.0 + grows * clamp(float(i) - EVEN, 0.0, 5.0));
        above = p.z - ground.x;
        float gap = above - canopy_top;
        bool over = gap > 0.0;
        float layer = layer_height(p.xy);
        float h = clamp(above / layer, 0.0, 1.0);
        vec4 voxel = voxel_at(p.xy, vec3(atlas_coordinate(p.xy), h) + vec3(scale, scale, 1.0) * offset, level);
        bool gone = t > scene_reach || (over && direction.z >= 0.0 && p.z > scene_top);
        found = above <= 0.0 ? 2 : gone ? 0 : 1;
        vec2 stand = stand_of(p.xy, voxel);
        float within = -log2(1.0 - opacity_of(voxel)) * ds / voxel_size;
        float tau = found == 1 && !over && above <= layer ? within * stand.x : 0.0;
        float passed = depth + tau;
        bool stops = passed > closed;
        if (depth <= wanted && (passed > wanted || stops)) {
            float aside = (min((wanted - depth) / max(tau, 1e-6), BEYOND) - jitter.x) * ds * (scale > 1.0 ? 1.0 : SHARP);
            event.place = vec4(p + aside * direction, clamp(h + aside * climb / layer, 0.0, 1.0));
            event.voxel = voxel;
            stops = stops || ends;
        }
        depth = stops ? 1e3 : passed;
        if (found == 1) {
            found = stops ? 0 : 1;
            previous = t;
            before = above;
            // No skip passes through the ground: a brink may stand in an empty canopy.
            float safe = step_above(over ? gap : above, direction, ground);
            float skip = max((free_voxels(voxel) - 1.0) / rate, stand.y - length(foot_of(p.xy, voxel) - p.xy) - CROWN_REACH);
            t += over ? max(safe, 0.5 * ds) : max(ds, min(skip, safe));
        }
    }
    event.opacity = 1.0 - exp2(-depth);
    if (found == 2) {
        float hit = ground_crossing(origin, direction, vec2(previous, t), vec2(before, above));
        add_matter(event, vec4(origin + hit * direction, GROUND), vec4(0.0), 1.0);
    }
}
