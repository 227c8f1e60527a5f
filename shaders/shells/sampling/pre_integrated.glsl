// Between samples extinction goes straight from one to the next, and light by the same factor for the same depth; what reaches the eye
// of it is a closed form. After Engel, Kraus and Ertl 2001, "High-quality pre-integrated volume rendering"; formulas g.
//
// Symbols: the paper's s_f, s_b, at the ends of a slab <-> first, last; its d <-> length_of_step [m]; depth, optical depth of the slab
// [-]; fall, logarithm of the light at its front over that at its back. Deviations: no table: with voxels of colour the closed form takes
// its place; light goes exponentially, as sunlight does in matter, instead of straight: c0 (1 - T) + (c1 - c0) moved.

struct SamplingEnd {
    vec3 source;
    float extinction;
};

SamplingEnd sampling_end(Ray ray, Segment segment, float lambda, float level) {
    vec3 place = mix(segment.from, segment.to, lambda);
    Matter matter = matter_at(place, level);
    float distance = mix(segment.near, segment.far, lambda);
    return SamplingEnd(light_source(ray, distance, place, level, matter, segment.gradients), matter.extinction);
}

// Share of the way from the front's light to the back's that the eye sees, times the slab's opacity.
float sampling_moved(float depth, float front, float back, float hidden) {
    float linear = depth < 0.01 ? depth * (0.5 - depth / 3.0) : hidden / depth - exp(-depth);
    float fall = clamp(log(max(front, 1.0e-9) / max(back, 1.0e-9)), -12.0, 12.0), sum = depth + fall;
    float seen = abs(sum) < 0.01 ? depth * (1.0 - 0.5 * sum) : depth * (1.0 - exp(-sum)) / sum;
    return abs(fall) < 0.02 ? linear : clamp((hidden - seen) / (1.0 - exp(-fall)), 0.0, hidden);
}

void sampling_segment(Ray ray, Segment segment, inout vec4 sum) {
    float level = filter_level(segment.near, segment.gradients);
    vec3 voxels = (segment.to - segment.from) * vec3(textureSize(shell_matter, 0)) * exp2(-level);
    float share = 1.0 / clamp(ceil(length(voxels) * sampling_rate), 1.0, float(SAMPLING_MOST));
    float length_of_step = (segment.far - segment.near) * share, lambda = 0.0;
    SamplingEnd first = sampling_end(ray, segment, 0.0, level);
    do {
        lambda += share;
        SamplingEnd last = sampling_end(ray, segment, min(lambda, 1.0), level);
        float depth = 0.5 * (first.extinction + last.extinction) * length_of_step;
        float hidden = depth < 1.0e-3 ? depth * (1.0 - 0.5 * depth) : 1.0 - exp(-depth);
        // Where there is no matter at one end, the other's light is all there is.
        vec3 front = first.extinction > 0.0 ? first.source : last.source, back = last.extinction > 0.0 ? last.source : front;
        float moved = sampling_moved(depth, dot(front, vec3(1.0)), dot(back, vec3(1.0)), hidden);
        sum += (1.0 - sum.a) * vec4(hidden * front + moved * (back - front), hidden);
        first = last;
    } while (lambda < 0.9999 && sum.a < OPAQUE);
}
