// Every voxel that a segment crosses, with the length of its path in it. Amanatides and Woo 1987, "A fast voxel traversal
// algorithm"; Dufort 2005, section 5.1.2; errata 002-1, 002-4, 002-10.
//
// Symbols: at, in voxels of the level that is read, whose borders are whole numbers; where matter is interpolated, borders run through
// their centres, and two nodes of Gauss and Legendre stand for the cubic between two borders; lambda in [0, 1] along the segment.
// first, last: matter at the nodes; the source's change between them is linear in the optical depth (formulas g).

const float SAMPLING_NODE = 0.2113248654; // of two, on [0, 1]
const float SAMPLING_NOTHING = 1.0e-6;

// Adds matter whose light goes from one colour to another along a depth: c0 (1 - T) + (c1 - c0) ((1 - T) / depth - T).
void sampling_add(inout vec4 sum, vec3 first, vec3 last, float depth) {
    float passed = exp(-depth);
    float hidden = depth < 1.0e-3 ? depth * (1.0 - 0.5 * depth) : 1.0 - passed;
    float moved = depth < 1.0e-2 ? depth * (0.5 - depth / 3.0) : hidden / depth - passed;
    sum += (1.0 - sum.a) * vec4(hidden * first + moved * (last - first), hidden);
}

vec3 sampling_light(Ray ray, Segment segment, float lambda, float level, Matter matter) {
    float distance = mix(segment.near, segment.far, lambda);
    return light_source(ray, distance, mix(segment.from, segment.to, lambda), level, matter, segment.gradients);
}

void sampling_segment(Ray ray, Segment segment, inout vec4 sum) {
#if INTERPOLATION == NEAREST
    float level = 0.0;
    const float shift = 0.0;
#else
    float level = floor(filter_level(segment.near, segment.gradients) + 0.5);
    const float shift = 0.5;
#endif
    vec3 counts = vec3(textureSize(shell_matter, int(level)));
    vec3 from = segment.from * counts - shift, along = (segment.to - segment.from) * counts;
    vec3 stride = 1.0 / max(abs(along), 1.0e-12);
    vec3 ahead = mix(ceil(from) - from, from - floor(from), lessThan(along, vec3(0.0)));
    vec3 crossing = mix(ahead, vec3(1.0), equal(ahead, vec3(0.0))) * stride; // lambda of the next border along each axis
    float lambda = 0.0;
    int steps = 0;
    do {
        float until = min(min(min(crossing.x, crossing.y), crossing.z), 1.0), width = until - lambda;
        float length_of_path = (segment.far - segment.near) * width;
        crossing += stride * vec3(lessThanEqual(crossing, vec3(until)));
#if INTERPOLATION == NEAREST
        float middle = lambda + 0.5 * width;
        Matter matter = matter_at(mix(segment.from, segment.to, middle), level);
        float depth = matter.extinction * length_of_path;
        vec3 light = vec3(0.0);
        if (depth > SAMPLING_NOTHING) light = sampling_light(ray, segment, middle, level, matter);
        sampling_add(sum, light, light, depth);
#else
        float early = lambda + SAMPLING_NODE * width, late = lambda + (1.0 - SAMPLING_NODE) * width;
        Matter first = matter_at(mix(segment.from, segment.to, early), level);
        Matter last = matter_at(mix(segment.from, segment.to, late), level);
        float depth = 0.5 * (first.extinction + last.extinction) * length_of_path;
        vec3 one = vec3(0.0), other = vec3(0.0);
        if (depth > SAMPLING_NOTHING) {
            one = sampling_light(ray, segment, early, level, first);
            other = sampling_light(ray, segment, late, level, last);
        }
        sampling_add(sum, one, one, 0.5 * first.extinction * length_of_path);
        sampling_add(sum, other, other, 0.5 * last.extinction * length_of_path);
#endif
        lambda = until;
        steps++;
    } while (lambda < 1.0 && steps < SAMPLING_MOST && sum.a < OPAQUE);
}
