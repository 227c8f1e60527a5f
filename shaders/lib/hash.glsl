// Integer hash for noise and random choices, the same bits on every machine and in numpy (uint32).
//
// Wellons 2018, "Prospecting for Hash Functions": lowbias32, constants 0x7feb352d and 0x846ca68b, shifts 16, 15, 16.
// Does not claim: cryptographic strength; its avalanche bias is 0.174 by Wellons' measure.

uint lowbias32(uint x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    x ^= x >> 16;
    return x;
}

// A hash's upper 24 bits as a number in [0, 1), exactly representable in float32.
float hash_unit(uint hash) {
    return float(hash >> 8) * (1.0 / 16777216.0);
}
