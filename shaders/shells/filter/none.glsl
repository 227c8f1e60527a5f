// The finest voxels, however small on the screen.

float filter_level(float distance, mat3 gradients) {
    return 0.0;
}

float filter_extinction(float own, vec3 place, float level) {
    return own;
}
