// Two streams. Shettle & Weinman 1970, "The transfer of solar irradiance through inhomogeneous turbid atmospheres evaluated by
// Eddington's approximation"; Joseph, Wiscombe & Weinman 1976, "The delta-Eddington approximation".
// Symbols: g phase_asymmetry [-]; f = g^2 the peak's share [-]; tau' = (1 - f) tau; mu cosine of the sun [-]; formulas a5.
// Deviations: radiance is order 1 by the true P, and the flux that it leaves by Eddington's exit law.
// Does not claim: the glow round the sun in a thin layer; azimuth beyond order 1. Errs by 0.07 in flux where the sun grazes.

#include "clouds/slab.glsl"

vec3 scattering_direct(float tau, float mu) {
    return vec3(slab_direct(tau, mu));
}

vec3 scattering_transmittance(float tau, float mu) {
    float m = max(mu, SLAB_GRAZING);
    vec3 g = phase_asymmetry;
    vec3 through = exp(-min((1.0 - g * g) * (tau / m), vec3(SLAB_DEEPEST)));
    return ((2.0 / 3.0 + m) + (2.0 / 3.0 - m) * through) / (4.0 / 3.0 + (1.0 - g) * tau);
}

vec3 scattering_reflectance(float tau, float mu) {
    return max(1.0 - scattering_transmittance(tau, mu), 0.0);
}

vec3 scattering_diffuse_reflectance(float tau) {
    vec3 thick = 0.75 * (1.0 - phase_asymmetry) * tau;
    return thick / (1.0 + thick);
}

vec3 scattering_up(Slab given) {
    Slab s = slab_safe(given);
    vec3 once = textureLod(scattering_fluxes, slab_flux_place(0.0, s.optical_depth, s.mu_sun), 0.0).rgb
        * slab_met(s.optical_depth, s.mu_sun);
    vec3 rest = max(scattering_reflectance(s.optical_depth, s.mu_sun) - once, 0.0);
    return phase_value(s.cosine) * slab_first_up(s, vec3(1.0)) + rest * s.mu_sun * slab_exit(s.mu_view);
}

vec3 scattering_down(Slab given) {
    Slab s = slab_safe(given);
    vec3 once = textureLod(scattering_fluxes, slab_flux_place(1.0, s.optical_depth, s.mu_sun), 0.0).rgb
        * slab_met(s.optical_depth, s.mu_sun);
    vec3 rest = max(scattering_transmittance(s.optical_depth, s.mu_sun) - slab_direct(s.optical_depth, s.mu_sun) - once, 0.0);
    return phase_value(s.cosine) * slab_first_down(s, vec3(1.0)) + rest * s.mu_sun * slab_exit(s.mu_view);
}

// Light that leaves on the sunlit side (up) or on the other.
vec3 scattering_leaving(Slab s, bool up) {
    return up ? scattering_up(s) : scattering_down(s);
}
