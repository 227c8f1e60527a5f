// A texture of few bytes a voxel, small enough for a CPU's caches: what the opacity of a place is, and how far a ray may go on.
// Bytes of renderer/shells/texture/strides.py; formulas g, Chebyshev distances.
// Symbols: number, as matter_stored takes it, of 16 bits in two bytes that are each interpolated; stride, voxels along any axis.

struct Coded {
    float number;
    float stride;
};

Coded coded_at(vec3 place, float level) {
    vec3 bytes = 255.0 * textureLod(shell_coded, place, level).rgb;
    float above = bytes.r - CODED_FIRST;
    // Interpolated distances may be nearly a voxel and a half too great for what is interpolated itself.
    return Coded(max(above + bytes.g / 255.0, 0.0) / (255.0 - CODED_FIRST),
                 max(-above / CODED_PER_VOXEL - 0.65, bytes.b / CODED_FAINT));
}
