// A shadow hemisphere from its largest harmonics, one cosine each. Porquet 2005, section on self-shadowing; errata 003-5.
//
// Symbols: f(a, b) = mean + sum of amplitude cos(2 pi (u a + v b) + phase), a and b shares of a turn along azimuth and
// elevation. Layout, numbers of harmonics and quantisers: renderer/directional/codes/harmonics.py, which has the twin.
// No claim: f rings beside the edges of shadows; it is clamped.

const float HARMONICS_MOST = 0.64072886193; // 1 / (8 sin(pi / 16)), amplitude of code 31
const float HARMONICS_STEP = 0.16672140246; // log2(MOST / 0.02) / 30
const int HARMONICS_KEPT = (SELF_SHADOW_SIZE - 1) / 2;

// Periods along azimuth and elevation of a harmonic's number.
ivec2 harmonics_periods(int number) {
    ivec2 periods = ivec2(number >> 3, number & 7);
    if (periods.x == 0 && (periods.y == 0 || periods.y > 4)) periods = ivec2(8, max(periods.y - 4, 0));
    return ivec2(periods.x, periods.y > 4 ? periods.y - 8 : periods.y);
}

float self_shadow_visibility(Surfel surfel, vec3 towards) {
    vec3 local = shadow_local(surfel, towards);
    vec2 place = shadow_place(local);
    float rows = float(self_shadow_elevations);
    vec2 turn = vec2(place.y / float(self_shadow_azimuths), clamp(place.x - 0.5, 0.0, rows - 1.0) / rows);
    float around = 1.0 - shadow_zenith(place);
    float lit = float((shadow_word(surfel.index, HARMONICS_KEPT >> 1)) & 255u) / 255.0;
    for (int k = 0; k < HARMONICS_KEPT; k++) {
        int field = int(shadow_word(surfel.index, k >> 1) >> uint(16 * (k & 1)));
        int level = (field >> 6) & 31;
        float amplitude = level == 0 ? 0.0 : HARMONICS_MOST * exp2(float(level - 31) * HARMONICS_STEP);
        ivec2 periods = harmonics_periods(field & 63);
        // Shares of a turn are brought near 0 first: a cosine of many turns is none in 32 bits.
        float wave = dot(vec2(periods), turn) + float((field >> 11) & 31) / 32.0;
        lit += amplitude * cos(TURN * (wave - floor(wave))) * (periods.x == 0 ? 1.0 : around);
    }
    return local.z > 0.0 ? clamp(lit, 0.0, 1.0) : 0.0;
}
