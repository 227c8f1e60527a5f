// Opacity from the nearest voxel of a place moved by chance, and light at a few places a ray, chosen by how much of each is seen.
// Pharr, Wronski, Salvi and Fajardo 2024, "Filtering after shading with stochastic texture filtering"; Chao 1982, "A general purpose
// unequal probability sampling plan"; formulas g.
//
// Symbols: shift, up to half a voxel either way along each axis: the mean of a voxel's opacity over it is the interpolated one;
// sampling_voxels, a byte a voxel, of which renderer/shells/texture/strides.py tells: extinction, and how far a ray may go with it;
// lambda in [0, 1] along the segment; passed, left, shares of the light that pass; stratum, of the opacity in SAMPLING_PLACES equal
// shares: of what hides it, one place is kept in proportion to its weight, as the sampling plan has it; its weight is all of theirs.
// Deviations: a rational function stands for the logarithm of where in a step a place lies; light is filtered before it is looked up, as the thesis has it; it changes less than opacity. Where voxels
// interpolate extinctions, the mean is of opacities still.

struct SamplingPlace {
    float weight;
    float at;  // m
    int tet;
};

SamplingPlace sampling_places[SAMPLING_PLACES];
float sampling_chance;
vec3 sampling_shift;
float sampling_start; // of a step
float sampling_dither;

void sampling_begin() {
    float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    vec3 turned = fract(noise * vec3(1.0, 7.0, 13.0) + sample_shift * vec3(0.8191725, 0.6710436, 0.5497005));
    vec4 others = fract(noise * vec4(3.0, 5.0, 17.0, 23.0) + sample_shift * vec4(0.6180340, 0.7548777, 0.5698403, 0.8566749));
#if INTERPOLATION == NEAREST
    sampling_shift = vec3(0.0);
#else
    sampling_shift = sampling_jitter * (turned - 0.5);
#endif
    sampling_start = 0.5 + sampling_jitter * (others.x - 0.5);
    sampling_dither = 0.5 + sampling_jitter * (others.y - 0.5);
    sampling_chance = others.z;
    for (int k = 0; k < SAMPLING_PLACES; k++) sampling_places[k] = SamplingPlace(0.0, 0.0, 0);
}

// A whole level, the nearest two in turn.
float sampling_level(float near, mat3 gradients) {
    return floor(filter_level(near, gradients) + sampling_dither);
}

void sampling_segment(Ray ray, Segment segment, inout vec4 sum) {
    float level = sampling_level(segment.near, segment.gradients);
    vec3 counts = vec3(textureSize(sampling_voxels, 0)) * exp2(-level), along = segment.to - segment.from;
    vec3 from = segment.from + sampling_shift / counts, voxels = abs(along * counts);
    float share = 1.0 / clamp(ceil(length(voxels) * sampling_rate), 1.0, float(SAMPLING_MOST));
    float steps_a_voxel = 1.0 / (max(max(voxels.x, voxels.y), max(voxels.z, 1.0e-6)) * share);
    float length_of_step = (segment.far - segment.near) * share, densest = voxels_density * STRIDE_DENSEST / reference_length;
    float lambda = sampling_start * share, passed = 1.0 - sum.a;
    do {
        vec3 place = from + lambda * along;
        float code = textureLod(sampling_voxels, place, level).r;
        bool empty = code < STRIDE_FAINT, faint = code < STRIDE_OTHER;
        float root = faint ? code * STRIDE_FAINT_CODING.x - STRIDE_FAINT_CODING.y : code * STRIDE_CODING.x - STRIDE_CODING.y;
        float stride = empty ? 255.0 * code - 0.99 : faint ? STRIDE_OF_FAINT - 1.0 : 0.0;
        float steps = max(floor(stride * steps_a_voxel), 1.0);
        float extinction = filter_extinction(root * root * densest, place, level);
        float left = empty ? passed : passed * exp(-extinction * length_of_step * steps), weight = passed - left;
        float stratum = floor((1.0 - passed) * float(SAMPLING_PLACES)), before = 0.0;
        for (int k = 0; k < SAMPLING_PLACES; k++) before = stratum == float(k) ? sampling_places[k].weight : before;
        float total = before + weight, level_of = sampling_chance * total;
        bool take = level_of < weight;
        float of = take ? weight : before;
        sampling_chance = of > 0.0 ? clamp((take ? level_of : level_of - weight) / of, 0.0, 1.0) : sampling_chance;
        // Within its step a place lies where even matter has hidden as much: at its start where that is opaque.
        float within = sampling_chance / (1.0 + extinction * length_of_step * steps * (1.0 - sampling_chance));
        float at = mix(segment.near, segment.far, lambda + (steps * within - sampling_start) * share);
        for (int k = 0; k < SAMPLING_PLACES; k++) {
            bool mine = stratum == float(k);
            sampling_places[k].weight = mine ? total : sampling_places[k].weight;
            sampling_places[k].at = mine && take ? at : sampling_places[k].at;
            sampling_places[k].tet = mine && take ? tet_here : sampling_places[k].tet;
        }
        passed = left;
        lambda += share * steps;
    } while (lambda < 1.0 && passed > 1.0 - OPAQUE);
    sum.a = 1.0 - passed;
}

vec3 sampling_light(Ray ray, SamplingPlace chosen) {
    Segment segment = tet_segment(ray, chosen.tet, chosen.at, chosen.at);
    tet_here = chosen.tet;
    float level = sampling_level(chosen.at, segment.gradients);
    Matter matter = matter_at(segment.from, level);
    vec3 source = light_source(ray, chosen.at, segment.from, level, matter, segment.gradients);
    return chosen.weight > 0.0 ? chosen.weight * source : vec3(0.0);
}

// Takes the first place that is left: rays of few places, as those that meet a surface, are done before others.
SamplingPlace sampling_next() {
    SamplingPlace next = SamplingPlace(0.0, 0.0, 0);
    for (int k = 0; k < SAMPLING_PLACES; k++) {
        SamplingPlace place = sampling_places[k];
        bool first = place.weight > 0.0 && next.weight == 0.0;
        next.weight = first ? place.weight : next.weight;
        next.at = first ? place.at : next.at;
        next.tet = first ? place.tet : next.tet;
        sampling_places[k].weight = first ? 0.0 : place.weight;
    }
    return next;
}

void sampling_rest(Ray ray, inout vec4 sum) {
    SamplingPlace next = sampling_next();
    do {
        sum.rgb += sampling_light(ray, next);
        next = sampling_next();
    } while (next.weight > 0.0);
}
