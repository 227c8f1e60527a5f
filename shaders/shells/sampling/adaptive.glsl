// As many samples as a segment crosses voxels, of the level that is read; those in empty voxels are not lit.
// After Levoy 1990, "Efficient ray tracing of volume data"; errata 002-1, 002-4, 002-5.
//
// Symbols: rate, samples a voxel; lambda in [0, 1] along the segment; alpha = 1 - exp(-extinction l), l the step's length (m).

const float SAMPLING_NOTHING = 1.0e-5; // opacity of a step that is not worth a light

void sampling_segment(Ray ray, Segment segment, inout vec4 sum) {
    float level = filter_level(segment.near, segment.gradients);
    vec3 voxels = (segment.to - segment.from) * vec3(textureSize(shell_matter, 0)) * exp2(-level);
    float share = 1.0 / clamp(ceil(length(voxels) * sampling_rate), 1.0, float(SAMPLING_MOST));
    float length_of_step = (segment.far - segment.near) * share;
    float lambda = 0.5 * share;
    do {
        Matter matter;
        float at, depth;
        do {
            at = lambda;
            matter = matter_at(mix(segment.from, segment.to, at), level);
            depth = matter.extinction * length_of_step;
            lambda += share;
        } while (depth < SAMPLING_NOTHING && lambda < 1.0);
        float distance = mix(segment.near, segment.far, at);
        vec3 source = light_source(ray, distance, mix(segment.from, segment.to, at), level, matter, segment.gradients);
        sum += (1.0 - sum.a) * (1.0 - exp(-depth)) * vec4(source, 1.0);
    } while (lambda < 1.0 && sum.a < OPAQUE);
}
