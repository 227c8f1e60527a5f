// The level whose voxels are as wide as a pixel.
//
// Symbols: distance of a pixel's footprint (m); gradients of u and v (1/m), by which a voxel's sides follow; bias, levels. The longer
// side counts: where a mapping is drawn out, the other is finer than it would need to be, and nothing is blurred by more than a pixel.

float footprint_level(float distance, mat3 gradients, float bias) {
    vec3 voxels = vec3(textureSize(shell_matter, 0));
    float widest = min(length(gradients[0]) * voxels.x, length(gradients[1]) * voxels.y); // voxels a metre
    return clamp(log2(max(pixel_width(distance) * widest, 1.0e-6)) + bias, 0.0, filter_coarsest);
}
