// Where a ray meets the canopy's envelope and the ground. Formulas i (heightfields), safe steps by the terrain's steepest slope.
// Symbols: origin, direction the ray [m, unit]; t distance [m]; gap height above the canopy's top [m].

// A step that cannot pass through the canopy's envelope, from a gap above it. Two bounds hold, so the longer serves:
// the ground is nowhere steeper than S (Lipschitz), and its slope changes by at most kappa a metre and a cell's worth at once, so
// that over s metres the gap shrinks by at most rate s + kappa s^2 / 2. The second closes in on a smooth slope quadratically.
// Symbols: ground height and slopes (world.glsl), S terrain_steepness, kappa terrain_bend.
float step_above(float gap, vec3 direction, vec3 ground) {
    float run = length(direction.xy);
    float kappa = terrain_bend * run * run;
    float rate = dot(ground.yz, direction.xy) - direction.z + terrain_bend * terrain_cell * run;
    float bent = 2.0 * gap / max(rate + sqrt(rate * rate + 2.0 * kappa * gap), 1e-3);
    return max(gap / max(terrain_steepness * run - direction.z, 1e-4), bent);
}

// A voxel's foot and another's are both within 8 m along each axis: nothing stands nearer than the next stand less that, and a texel.
const float GLADE_REACH = 28.0;

// Voxels that a ray crosses per metre, at most, along any axis of the sheared lattice; upwards, those of the lowest stand.
float voxel_rate(vec3 direction) {
    float run = length(direction.xy);
    float rise = (abs(direction.z) + (terrain_steepness + canopy_grade) * run) / canopy_least;
    return max(1.1547005383792515 * run, rise) / voxel_size;
}

// Gap at which a ray counts as arrived, per metre of its length: a quarter of a pixel in a picture of 500 lines.
const float ENTRY_TOLERANCE = 0.0004;

// Where the ray may first meet the canopy, by safe steps over its upper envelope from `t` on; -1 when it never does.
float canopy_entry(vec3 origin, vec3 direction, float t) {
    float found = t < 0.0 ? -1.0 : 0.0;
    for (int i = 0; i < ENTRY_STEPS && found == 0.0; i++) {
        vec3 p = origin + t * direction;
        vec3 ground = ground_at(p.xy);
        float gap = p.z - ground.x - canopy_top;
        bool past = t > scene_reach || (p.z > scene_top && direction.z >= 0.0);
        found = past ? -1.0 : gap <= 0.1 + ENTRY_TOLERANCE * t ? 1.0 : 0.0;
        t += found == 0.0 ? max(step_above(gap, direction, ground), 0.1) : 0.0;
    }
    return found < 0.0 ? -1.0 : t;
}

// Where a ray that starts above everything comes down to the scene's top.
float scene_entry(vec3 origin, vec3 direction) {
    return origin.z <= scene_top ? 0.0 : direction.z < 0.0 ? (scene_top - origin.z) / direction.z : -1.0;
}

// Ground between t.x (above it) and t.y (at or below it), by regula falsi on the height above the ground, `above` at either end [m].
float ground_crossing(vec3 origin, vec3 direction, vec2 t, vec2 above) {
    for (int i = 0; i < 2; i++) {
        float middle = mix(t.x, t.y, clamp(above.x / max(above.x - above.y, 1e-6), 0.02, 0.98));
        vec3 p = origin + middle * direction;
        float there = p.z - ground_height(p.xy);
        if (there > 0.0) { t.x = middle; above.x = there; } else { t.y = middle; above.y = there; }
    }
    return mix(t.x, t.y, clamp(above.x / max(above.x - above.y, 1e-6), 0.0, 1.0));
}
