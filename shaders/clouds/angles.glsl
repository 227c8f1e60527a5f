// Where an angle stands in tables whose steps shrink towards 0 and 180 degrees.
// Symbols: cosine of the angle [-]; place in the table [-], 0 at 0 degrees and 1 at 180: the fourth root of 1 - |cosine|, so that
// steps are about 0.02 degrees at a peak and 0.1 degrees at the fogbow.

float angle_place(float cosine) {
    float near = 0.5 * sqrt(sqrt(max(1.0 - abs(cosine), 0.0)));
    return cosine > 0.0 ? near : 1.0 - near;
}
