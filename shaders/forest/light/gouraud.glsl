// Gouraud light. Gouraud 1971; Cohen 2004, listing 10.1 (`lightDir.z` in the face's frame).
// Symbols: sun_direction unit vector to the sun, voxel_normal and ground_normal unit vectors (world).
// Deviation: the normal is interpolated per pixel from the grid's nodes, not the light per vertex.

// Listing 10.1: the light is the cosine in the ground's frame, whatever the voxel.
float light_factor(vec3 voxel_normal, vec3 ground_normal) {
    return mix(1.0, max(dot(ground_normal, sun_direction), 0.0), light_strength);
}
