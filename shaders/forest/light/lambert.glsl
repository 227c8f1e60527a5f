// Lambert light with per-voxel normals. Blinn 1978; Cohen 2004, sections 2.1 and 7.2.
// Symbols: sun_direction unit vector to the sun; matter.normal unit vector (world), matter.albedo reflectance.
// Deviation: the normal is renormalised after filtering (errata 000-4). It claims neither translucent leaves nor leaves that face
// elsewhere than their voxel's mean.

// Section 7.2: N . l, never negative; albedo / pi is Lambert's constant.
vec3 light_reflected(Matter matter, vec3 to_eye) {
    return matter.albedo * INVERSE_PI * max(dot(matter.normal, sun_direction), 0.0);
}
