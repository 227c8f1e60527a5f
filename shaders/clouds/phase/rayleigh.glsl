// Rayleigh's phase function. Strutt 1871, "On the light from the sky"; Belcour 2009, section 2.3.1.
// Symbols: cosine of the scattering angle [-]; P = 3 (1 + cosine^2) / (16 pi) [1/sr], integral over the sphere 1.
// Deviations: none. Convolved with itself: its one moment, 1/10, squared.
// Does not know: droplets, whose size is many wavelengths.

const float PHASE_QUARTER = 0.07957747154594767; // 1 / (4 pi)

vec3 phase_value(float cosine) {
    return vec3(0.75 * PHASE_QUARTER * (1.0 + cosine * cosine));
}

vec3 phase_twice(float cosine) {
    return vec3(PHASE_QUARTER * (1.0 + 0.025 * (3.0 * cosine * cosine - 1.0)));
}
