// As many samples as a segment crosses voxels, of the level that is read.
// After Levoy 1990, "Efficient ray tracing of volume data"; errata 002-1, 002-4, 002-5.
//
// Symbols: rate, samples a voxel; lambda in [0, 1] along the segment; alpha = 1 - exp(-extinction l), l the step's length (m).
// Deviations: light is looked for once for samples that together hide `lit` of what is behind them, or that end a segment: by the
// normal of the one that is seen most, where all of them have their middle. Colours are each sample's own.

void sampling_segment(Ray ray, Segment segment, inout vec4 sum) {
    float level = filter_level(segment.near, segment.gradients);
    vec3 voxels = (segment.to - segment.from) * vec3(textureSize(shell_matter, 0)) * exp2(-level);
    float share = 1.0 / clamp(ceil(length(voxels) * sampling_rate), 1.0, float(SAMPLING_MOST));
    float length_of_step = (segment.far - segment.near) * share;
    // Elsewhere within their steps from picture to picture, or the steps would show in the shade of surfaces.
    float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))) + 0.6180340 * sample_shift);
    float lambda = (0.5 + sampling_jitter * (noise - 0.5)) * share;
    do {
        vec4 part = vec4(0.0);
        float middle = 0.0, most = 0.0, place = lambda, extinction = 0.0;
        do {
            Matter matter = matter_at(mix(segment.from, segment.to, lambda), level);
            float weight = (1.0 - part.a) * (1.0 - exp(-matter.extinction * length_of_step));
            part += weight * vec4(matter.colour, 1.0);
            middle += weight * lambda;
            bool more = weight > most;
            most = more ? weight : most;
            place = more ? lambda : place;
            extinction = more ? matter.extinction : extinction;
            lambda += share;
        } while (lambda < 1.0 && part.a < sampling_lit);
        float distance = mix(segment.near, segment.far, middle / max(part.a, 1.0e-6));
        Matter seen = Matter(part.rgb, extinction);
        vec3 source = light_source(ray, distance, mix(segment.from, segment.to, place), level, seen, segment.gradients);
        sum += (1.0 - sum.a) * vec4(source, part.a);
    } while (lambda < 1.0 && sum.a < OPAQUE);
}
