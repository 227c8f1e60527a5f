// Orders of scattering as printed. Belcour 2009, sections 3.2 and 4.3, after Bouthors, Neyret & Lefebvre 2006.
// Symbols: f = P phase_value, f * f phase_twice [1/sr]; kappa H_v = tau / mu optical path [-]; beta share sent ahead [-].
// Deviations: angles and convolution on the sphere, and order 1 of the other side, without which nothing could be drawn (errata
// 001-15, 001-16); the forward peak is drawn as a Gaussian as wide as it; beta = (1 + g) / 2; orders beyond 2 of the slab along the
// sun's ray leave evenly. The printed factor of order 2, that of order 1, is kept: it is about twice too bright.
// Does not claim: energy; what each formula sends comes on top of the others.

#include "clouds/slab.glsl"

vec3 scattering_ahead() {
    return 0.5 + 0.5 * phase_asymmetry;
}

vec3 scattering_direct(float tau, float mu) {
    return vec3(slab_direct(tau, mu));
}

vec3 scattering_transmittance(float tau, float mu) {
    float path = tau / max(mu, SLAB_GRAZING);
    vec3 ahead = scattering_ahead();
    return ahead / (path - (path - 1.0) * ahead);
}

vec3 scattering_reflectance(float tau, float mu) {
    return max(1.0 - scattering_transmittance(tau, mu), 0.0);
}

vec3 scattering_diffuse_reflectance(float tau) {
    return scattering_reflectance(tau, 0.5);
}

vec3 scattering_chosen(vec3 forward, vec3 single, vec3 twice, vec3 rest) {
    if (scattering_order == scattering_order_all) return forward + single + twice + rest;
    if (scattering_order == scattering_order_transparency) return vec3(0.0);
    if (scattering_order == scattering_order_forward) return forward;
    if (scattering_order == scattering_order_single) return single;
    return scattering_order == scattering_order_double ? twice : rest;
}

vec3 scattering_up(Slab given) {
    Slab s = slab_safe(given);
    vec3 once = slab_first_up(s, vec3(1.0));
    float path = min(s.optical_depth / s.mu_sun, SLAB_DEEPEST);
    vec3 ahead = scattering_ahead();
    vec3 known = (1.0 - ahead) * (1.0 - exp(-2.0 * path) + ahead * (1.0 - (1.0 + 2.0 * path) * exp(-2.0 * path))) / 2.0;
    vec3 rest = max(scattering_reflectance(s.optical_depth, s.mu_sun) - known, 0.0) * (4.0 * s.mu_sun / SLAB_FOUR_PI);
    return scattering_chosen(vec3(0.0), phase_value(s.cosine) * once, phase_twice(s.cosine) * once, rest);
}

vec3 scattering_down(Slab given) {
    Slab s = slab_safe(given);
    vec3 once = slab_first_down(s, vec3(1.0));
    float path = min(s.optical_depth / s.mu_sun, SLAB_DEEPEST);
    vec3 ahead = scattering_ahead();
    vec3 peak = exp(-(1.0 - phase_forward) * path) - exp(-path);
    vec3 known = exp(-path) * (1.0 + ahead * path * (1.0 + 0.5 * ahead * path));
    vec3 rest = max(scattering_transmittance(s.optical_depth, s.mu_sun) - known, 0.0) * (4.0 * s.mu_sun / SLAB_FOUR_PI);
    return scattering_chosen(peak * slab_glow(s.cosine, phase_spread, vec3(1.0)), phase_value(s.cosine) * once,
                             phase_twice(s.cosine) * once, rest);
}

// Light that leaves on the sunlit side (up) or on the other.
vec3 scattering_leaving(Slab s, bool up) {
    return up ? scattering_up(s) : scattering_down(s);
}
