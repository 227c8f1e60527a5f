// Slices parallel to the ground. Meyer & Neyret 1998; Decaudin & Neyret 2004; Cohen 2004, section 2.1; formulas b2.
// Symbols: N geometry_count sheets at h = (k + 1/2) / N; d' length of the ray between two sheets [m]; alpha opacity for one voxel.
// Deviation: each ray meets the sheets front to back instead of the sheets being drawn back to front (the same sum, stopped early).
// Comes apart into its sheets at grazing view: that is the method.

// Distance along the ray to the next sheet from `above` metres over the ground, climbing `climb` metres a metre.
float to_next_sheet(float above, float climb, float spacing, out float sheet) {
    float place = above / spacing - 0.5;
    sheet = climb < 0.0 ? ceil(place - 1e-3) - 1.0 : floor(place + 1e-3) + 1.0;
    float slope = abs(climb) < 1e-4 ? (climb < 0.0 ? -1e-4 : 1e-4) : climb;
    return ((sheet + 0.5) * spacing - above) / slope;
}

// Formulas b2: alpha' = 1 - (1 - alpha)^(d' / voxel).
void geometry_trace(vec3 origin, vec3 direction, float t, vec4 jitter, inout Event event) {
    vec3 offset = voxel_offset(jitter) * vec3(1.0, 1.0, 0.0);
    float previous = t;
    float before = origin.z + t * direction.z - ground_height(origin.xy + t * direction.xy);
    float above = before;
    int found = 1;
    for (int i = 0; i < MARCH_STEPS && found == 1; i++) {
        vec3 p = origin + t * direction;
        float layer = layer_height(p.xy);
        float spacing = layer / float(geometry_count);
        float longest = 2.0 * spacing;
        vec3 ground = ground_at(p.xy);
        above = p.z - ground.x;
        float gap = above - canopy_top;
        vec3 ahead = p + 0.25 * direction;
        // Of the height in the layer, which may itself be rising: in metres of the layer here.
        float climb = ((ahead.z - ground_height(ahead.xy)) * layer / layer_height(ahead.xy) - above) * 4.0;
        float sheet;
        float reach = to_next_sheet(above, climb, spacing, sheet);
        bool over = gap > 0.0;
        bool meets = !over && reach < longest && sheet >= 0.0 && sheet < float(geometry_count);
        found = above <= 0.0 ? 2 : t > scene_reach || (over && direction.z >= 0.0 && p.z > scene_top) ? 0 : 1;
        float hit = t + max(reach, 1e-3);
        vec3 q = origin + hit * direction;
        float h = clamp((sheet + 0.5) / float(geometry_count), 0.0, 1.0);
        float level = level_at(hit, jitter.z);
        vec4 voxel = voxel_at(q.xy, vec3(atlas_coordinate(q.xy), h) + exp2(level) * offset, level);
        float voxels = min(spacing / max(abs(climb), 0.02), 8.0 * spacing) / voxel_size;
        float path = geometry_correct_opacity ? voxels : 1.0;
        float alpha = meets && found == 1 ? (1.0 - pow(1.0 - opacity_of(voxel), path)) * stand_of(q.xy, voxel).x : 0.0;
        float opacity = 1.0 - (1.0 - event.opacity) * (1.0 - alpha);
        if (opacity > 0.98) {
            opacity = 1.0;
            found = 0;
        }
        add_matter(event, vec4(q, h), voxel, opacity);
        if (found == 1) {
            previous = t;
            before = above;
            t = meets ? hit : over ? t + max(step_above(gap, direction, ground), 0.01) : t + min(max(reach, 0.02), longest);
        }
    }
    if (found == 2) {
        float hit = ground_crossing(origin, direction, vec2(previous, t), vec2(before, above));
        add_matter(event, vec4(origin + hit * direction, GROUND), vec4(0.0), 1.0);
    }
}
