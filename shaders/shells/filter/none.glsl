// The finest voxels, however small on the screen.

float filter_level(float distance, mat3 gradients) {
    return 0.0;
}
