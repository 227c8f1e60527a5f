// Opacity by even steps, and light only where a ray's opacity has passed equal shares of what it may reach. After Levoy 1990,
// "Efficient ray tracing of volume data", and Danskin and Hanrahan 1992, "Fast algorithms for volume ray tracing"; formulas g.
//
// Symbols: lambda in [0, 1] along the segment; passed, left, shares of the light that pass; a ray's opacity is cut into
// SAMPLING_PLACES shares, and each is lit in the step that passes its middle, or nearby in other pictures; a last one whose middle
// is not reached is lit where the middle of its matter is.
// Deviations: one place stands for a step, where even matter of its depth has hidden about half of what it hides. Jitter moves
// whole pictures, and not pixels against each other: one picture is as smooth as their mean.

float sampling_at[SAMPLING_PLACES]; // m
float sampling_tet[SAMPLING_PLACES];
float sampling_weight[SAMPLING_PLACES];
float sampling_start; // of a step
float sampling_dither;
float sampling_middle; // of a share
float sampling_opacity;
float sampling_share;  // that is being passed
vec3 sampling_partial; // of it, weight times distance (m), and weight and tetrahedron of the cell that hides most

float sampling_turn(float by) {
    return sampling_jitter * (fract(0.5 + sample_shift * by) - 0.5);
}

void sampling_begin() {
    sampling_start = 0.5 + sampling_turn(0.6180340);
    sampling_dither = 0.5 + sampling_turn(0.7548777);
    sampling_middle = 0.5 + sampling_turn(0.5698403);
    sampling_share = 0.0;
    sampling_partial = vec3(0.0);
    sampling_opacity = 0.0;
    for (int k = 0; k < SAMPLING_PLACES; k++) sampling_at[k] = 0.0;
}

// A whole level, the nearest two in turn.
float sampling_level(float near, mat3 gradients) {
    return floor(filter_level(near, gradients) + sampling_dither);
}

void sampling_segment(Ray ray, Segment segment, inout vec4 sum) {
    float level = sampling_level(segment.near, segment.gradients);
    vec3 counts = vec3(textureSize(shell_coded, 0)) * exp2(-level), along = segment.to - segment.from;
    vec3 voxels = abs(along * counts);
    float share = 1.0 / clamp(ceil(length(voxels) * sampling_rate), 1.0, float(SAMPLING_MOST));
    float along_axis = max(max(voxels.x, voxels.y), max(voxels.z, 1.0e-6)) * share; // voxels a step
    float length_of_step = (segment.far - segment.near) * share, before = sum.a, passed = 1.0 - sum.a;
    float lambda = sampling_start * share, share_before = sampling_share, moment = sampling_partial.x;
    do {
        vec3 place = segment.from + lambda * along;
        Coded coded = coded_at(place, level);
        float steps = clamp(floor(coded.stride / along_axis), 1.0, max((1.0 - lambda) / share + sampling_start, 1.0));
        float depth = filter_extinction(matter_stored(coded.number), place, level) * length_of_step * steps;
        float weight = passed - passed * exp(-depth);
        float at = lambda + (steps / (2.0 + depth) - sampling_start) * share;
        for (int k = 0; k < SAMPLING_PLACES; k++) {
            sampling_at[k] = passed > 1.0 - (float(k) + sampling_middle) / float(SAMPLING_PLACES) ? at : sampling_at[k];
        }
        passed -= weight;
        float now = floor((1.0 - passed) * float(SAMPLING_PLACES)), own = 1.0 - passed - now / float(SAMPLING_PLACES);
        float distance = mix(segment.near, segment.far, at);
        moment = now > sampling_share ? own * distance : moment + weight * distance;
        sampling_share = now;
        lambda += share * steps;
    } while (lambda < 1.0 && passed > 1.0 - OPAQUE);
    sum.a = sampling_opacity = 1.0 - passed;
    for (int k = 0; k < SAMPLING_PLACES; k++) {
        float middle = (float(k) + sampling_middle) / float(SAMPLING_PLACES);
        bool mine = before < middle && sum.a >= middle;
        sampling_at[k] = mine ? mix(segment.near, segment.far, sampling_at[k]) : sampling_at[k];
        sampling_tet[k] = mine ? float(tet_here) : sampling_tet[k];
    }
    float hidden = sum.a - max(before, sampling_share / float(SAMPLING_PLACES));
    bool most = sampling_share > share_before || hidden > sampling_partial.y;
    sampling_partial = vec3(moment, most ? vec2(hidden, float(tet_here)) : sampling_partial.yz);
}

vec3 sampling_light(Ray ray, float at, int tet) {
    Segment segment = tet_segment(ray, tet, at, at);
    tet_here = tet;
    float level = sampling_level(at, segment.gradients);
    return light_source(ray, at, segment.from, level, matter_at(segment.from, level), segment.gradients);
}

// Takes the first place that is left: rays of few places, as those that meet a surface, are done before others.
vec3 sampling_next() {
    vec3 next = vec3(0.0);
    for (int k = 0; k < SAMPLING_PLACES; k++) {
        bool first = sampling_weight[k] > 0.0 && next.x == 0.0;
        next = first ? vec3(sampling_weight[k], sampling_at[k], sampling_tet[k]) : next;
        sampling_weight[k] = first ? 0.0 : sampling_weight[k];
    }
    return next;
}

void sampling_settle() {
    float partial = sampling_opacity - sampling_share / float(SAMPLING_PLACES);
    for (int k = 0; k < SAMPLING_PLACES; k++) {
        bool mine = sampling_share == float(k) && partial < sampling_middle / float(SAMPLING_PLACES);
        sampling_at[k] = mine ? sampling_partial.x / max(partial, 1.0e-9) : sampling_at[k];
        sampling_tet[k] = mine ? sampling_partial.z : sampling_tet[k];
    }
}

void sampling_light_all(Ray ray, inout vec4 sum) {
    float to = sampling_opacity;
    for (int k = SAMPLING_PLACES - 1; k >= 0; k--) {
        float from = float(k) / float(SAMPLING_PLACES);
        // Shares that the same step passes are one.
        bool there = to > from && (k == 0 || sampling_at[k] != sampling_at[max(k - 1, 0)]);
        sampling_weight[k] = there ? to - from : 0.0;
        to = there ? from : to;
    }
    vec3 next = sampling_next();
    do {
        vec3 light = sampling_light(ray, next.y, int(next.z));
        sum.rgb += next.x > 0.0 ? next.x * light : vec3(0.0);
        next = sampling_next();
    } while (next.x > 0.0);
}

void sampling_rest(Ray ray, inout vec4 sum) {
    sampling_settle();
    sampling_light_all(ray, sum);
}
