// A ray's light where its cells are drawn one by one, and where it walks through them: techniques of the slot `sampling` that
// light a ray as a whole are told of its beginning and its end.

void gather_begin() {
#if SAMPLING_WHOLE == 1
    sampling_begin();
#endif
}

void gather_rest(Ray ray, inout vec4 sum) {
#if SAMPLING_WHOLE == 1
    sampling_rest(ray, sum);
#endif
}

void gather_cell(Ray ray, Segment segment, inout vec4 sum) {
#if SAMPLING_WHOLE == 1
    vec4 cell = vec4(0.0);
    sampling_begin();
    sampling_segment(ray, segment, cell);
    sampling_rest(ray, cell);
    sum += (1.0 - sum.a) * cell;
#else
    sampling_segment(ray, segment, sum);
#endif
}
