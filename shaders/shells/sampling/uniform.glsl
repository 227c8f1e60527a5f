// The same number of samples in every segment. Dufort 2005, section 5.1.2; errata 002-1, 002-4, 002-5.
//
// Symbols: lambda in [0, 1] along the segment, (i + 1/2) / N; alpha_i = 1 - exp(-extinction l / N), l the segment's length (m);
// without correction each sample has the texture's own alpha, whatever its length. It misses voxels smaller than a step.

void sampling_segment(Ray ray, Segment segment, inout vec4 sum) {
    float share = 1.0 / sampling_samples;
#if SAMPLING_CORRECTION == 1
    float length_of_step = (segment.far - segment.near) * share;
#else
    float length_of_step = segment.far > segment.near ? reference_length : 0.0;
#endif
    float level = filter_level(segment.near, segment.gradients);
    float lambda = 0.5 * share;
    do {
        float distance = mix(segment.near, segment.far, lambda);
        vec3 place = mix(segment.from, segment.to, lambda);
        Matter matter = matter_at(place, level);
        float alpha = 1.0 - exp(-matter.extinction * length_of_step);
        vec3 source = light_source(ray, distance, place, level, matter, segment.gradients);
        sum += (1.0 - sum.a) * alpha * vec4(source, 1.0);
        lambda += share;
    } while (lambda < 1.0 && sum.a < OPAQUE);
}
