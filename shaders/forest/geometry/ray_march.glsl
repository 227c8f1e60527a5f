// Ray marching of the canopy layer, front to back, with early stop and empty-space skipping.
// Levoy 1990 (early stop, empty space); formulas (g). Today's way beside the thesis' slices.
// Symbols: alpha opacity for one voxel's length; ds step [m]; T transmittance; climb rise over the ground, metre per metre of the ray.
// Deviations: the step grows with the mip level, but across STEP_LAYERS layers at most, for it stands for them all; light is evaluated
// at one random level of opacity (events.glsl), not at every step; each ray reads nearest voxels at its own offset, whose mean over
// rays is trilinear interpolation.

// Layers of voxels that a step may cross, in its own measure.
const float STEP_LAYERS = 3.0;

// Length of a step at a level [m].
float step_at(float scale, float climb) {
    return geometry_step * voxel_size * min(scale, max(STEP_LAYERS / max(abs(climb), 1e-3), 1.0));
}

// Formulas g: front to back, T *= 1 - alpha'; alpha' = 1 - (1 - alpha)^(ds / voxel).
void geometry_trace(vec3 origin, vec3 direction, float t, vec4 jitter, inout Event event) {
    float rate = voxel_rate(direction);
    vec3 offset = voxel_offset(jitter);
    float previous = t;
    t += step_at(exp2(level_at(t, jitter.z)), direction.z) * jitter.x;
    int found = 1;
    for (int i = 0; i < MARCH_STEPS && found == 1; i++) {
        float level = level_at(t, jitter.z);
        float scale = exp2(level);
        vec3 p = origin + t * direction;
        vec3 ground = ground_at(p.xy);
        float ds = step_at(scale, direction.z - dot(ground.yz, direction.xy));
        float above = p.z - ground.x;
        float gap = above - canopy_top;
        bool over = gap > 0.0;
        float layer = layer_height(p.xy);
        float h = clamp(above / layer, 0.0, 1.0);
        vec4 voxel = voxel_at(vec3(atlas_coordinate(p.xy), h) + vec3(scale, scale, 1.0) * offset, level);
        bool gone = t > scene_reach || (over && direction.z >= 0.0 && p.z > scene_top);
        found = above <= 0.0 ? 2 : gone ? 0 : 1;
        vec2 stand = stand_of(p.xy, voxel);
        float within = 1.0 - pow(1.0 - opacity_of(voxel), ds / voxel_size);
        float alpha = found == 1 && !over && above <= layer ? within * stand.x : 0.0;
        float opacity = 1.0 - (1.0 - event.opacity) * (1.0 - alpha);
        if (opacity > 1.0 - geometry_stop) {
            opacity = 1.0;
            found = 0;
        }
        add_matter(event, vec4(p, h), voxel, opacity);
        if (found == 1) {
            previous = t;
            // No skip passes through the ground: a brink may stand in an empty canopy.
            float safe = step_above(over ? gap : above, direction, ground);
            float skip = max((free_voxels(voxel) - 1.0) / rate, stand.y - GLADE_REACH);
            t += over ? max(safe, 0.5 * ds) : max(ds, min(skip, safe));
        }
    }
    if (found == 2) {
        float hit = ground_crossing(origin, direction, previous, t);
        add_matter(event, vec4(origin + hit * direction, GROUND), vec4(0.0), 1.0);
    }
}
