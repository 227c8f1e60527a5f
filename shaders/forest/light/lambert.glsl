// Lambert light with per-voxel normals. Blinn 1978; Cohen 2004, sections 2.1 and 7.2.
// Symbols: sun_direction unit vector to the sun; voxel_normal, ground_normal unit vectors (world).
// Deviation: the normal is renormalised after filtering (errata 000-4); it does not claim translucent leaves.

// Section 7.2: N . l, never negative.
float light_factor(vec3 voxel_normal, vec3 ground_normal) {
    return max(dot(voxel_normal, sun_direction), 0.0);
}
