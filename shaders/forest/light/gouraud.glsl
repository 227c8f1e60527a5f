// Gouraud light. Gouraud 1971; Cohen 2004, listing 10.1 (`lightDir.z` in the face's frame).
// Symbols: sun_direction unit vector to the sun, matter.slope unit normal of the ground (world), matter.albedo reflectance.
// Deviation: the normal is interpolated per pixel from the grid's nodes, not the light per vertex.

// Listing 10.1: the light is the cosine in the ground's frame, whatever the voxel.
vec3 light_reflected(Matter matter, vec3 to_eye) {
    return matter.albedo * INVERSE_PI * mix(1.0, max(dot(matter.slope, sun_direction), 0.0), light_strength);
}
