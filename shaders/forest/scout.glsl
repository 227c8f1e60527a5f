// How far every ray of a block of pixels may run before any of them can meet the canopy: cone marching.
// Cone marching (Seven and Fulcrum 2012, "Cone marching": one march for a block of pixels), over a heightfield of bounded slope.
// Symbols: r radius of the block's cone [m], k its growth per metre of ray; S terrain_steepness; gap height over the canopy [m].
// Over the whole cone the gap is at least gap - (S + 1) r: a ray r away is at most r lower, over ground at most S r higher.

// Distance [m] at which the frame's own rays begin, or -1 where the whole block looks past the scene.
// Symbols: side of the block [px]; t where the rays of a larger block around it may begin.
float scout_distance(vec2 block, float side, float t) {
    vec3 origin, direction, edge_origin, edge;
    camera_ray((block + 0.5) * side, origin, direction);
    camera_ray(block * side - 0.5, edge_origin, edge);
    float k = length(edge - direction) * 1.1;
    float r0 = length(edge_origin - origin) * 1.1;
    float run = length(direction.xy) + k;
    float sinking = max(terrain_steepness * run - direction.z + k, 1e-3) + (terrain_steepness + 1.0) * k;
    if (t < 0.0) return -1.0;
    for (int i = 0; i < ENTRY_STEPS; i++) {
        vec3 p = origin + t * direction;
        float gap = p.z - ground_height(p.xy) - canopy_top - (terrain_steepness + 1.0) * (r0 + k * t);
        bool past = p.z - r0 - k * t > scene_top && direction.z - k >= 0.0;
        if (past || t > scene_reach) return -1.0;
        if (gap <= 0.25) break;
        t += gap / sinking;
    }
    return t;
}
