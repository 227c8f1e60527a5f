// Henyey and Greenstein's phase function. Henyey & Greenstein 1941, "Diffuse radiation in the galaxy", equation 2.
// Symbols: g mean cosine of the scattering angle [-], phase_asymmetry; P [1/sr], integral over the sphere 1.
// Deviations: none. Convolved with itself it is again of its kind, with g squared.
// Does not know: fogbow and glory; a peak as narrow as diffraction's.

const float PHASE_QUARTER = 0.07957747154594767; // 1 / (4 pi)

vec3 phase_lobe(vec3 g, float cosine) {
    vec3 base = max(1.0 + g * g - 2.0 * g * cosine, 1e-6);
    return PHASE_QUARTER * (1.0 - g * g) / (base * sqrt(base));
}

vec3 phase_value(float cosine) {
    return phase_lobe(phase_asymmetry, cosine);
}

vec3 phase_twice(float cosine) {
    return phase_lobe(phase_asymmetry * phase_asymmetry, cosine);
}
