// The level whose voxels are as wide as a pixel. Dufort 2005, section 5.3.2; Williams 1983.
//
// Symbols: filter_bias, levels coarser than the pixel asks for. What a coarse voxel hides is the same from all sides.

float filter_level(float distance, mat3 gradients) {
    return footprint_level(distance, gradients, filter_bias);
}

float filter_extinction(float own, vec3 place, float level) {
    return own;
}
