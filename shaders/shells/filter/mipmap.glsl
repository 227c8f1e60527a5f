// The level whose voxels are as wide as a pixel. Dufort 2005, section 5.3.2; Williams 1983.
//
// Symbols: footprint of a pixel at a distance (m); gradients of u and v (1/m), by which a voxel's sides follow. The longer of the two
// counts: where a mapping is drawn out, the other is finer than it would need to be, and nothing is blurred by more than a pixel.

float filter_level(float distance, mat3 gradients) {
    vec3 voxels = vec3(textureSize(shell_matter, 0));
    float widest = min(length(gradients[0]) * voxels.x, length(gradients[1]) * voxels.y); // voxels a metre
    return clamp(log2(max(pixel_width(distance) * widest, 1.0e-6)) + filter_bias, 0.0, filter_coarsest);
}
