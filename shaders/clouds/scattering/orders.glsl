// Orders of scattering, corrected. Bouthors, Neyret & Lefebvre 2006; Belcour 2009, section 4.3; formulas a3, a4, a5.
// Symbols: P phase_value, P2 = P * P phase_twice [1/sr]; tau optical depth [-]; mu_l, mu_v cosines of sun and view [-]; b, c, beta of
// the one-dimensional slab [-]; f phase_forward [-], the share scattered by less than 5 degrees, and phase_spread [rad^2].
// Deviations: order 2 has its own factor, half of a quadratic (errata 001-16); three deflections and more by the peak are a Gaussian
// around the sun; what is left of the slab's energy leaves by Eddington's law. Fits stand at cosines of 0.2 and more.
// Does not claim: azimuth beyond order 2; energy between orders where the fit and the closed forms disagree in thin layers.

#include "clouds/slab.glsl"

const vec3 SCATTERING_FITS[4] = vec3[4](vec3(0.602, 1.797, 0.8913), vec3(0.736, 0.702, 0.9051), vec3(0.948, 0.137, 0.9100),
                                        vec3(1.196, 0.329, 0.9062)); // b, c, beta at cosines 0.2, 0.4, 0.7, 1
const float SCATTERING_FITTED = 0.854; // mean cosine for which they were fitted

vec3 scattering_direct(float tau, float mu) {
    return vec3(slab_direct(tau, mu));
}

vec3 scattering_transmittance(float tau, float mu) {
    float m = max(mu, SLAB_GRAZING);
    vec3 fit = m < 0.4 ? mix(SCATTERING_FITS[0], SCATTERING_FITS[1], (m - 0.2) / 0.2)
        : m < 0.7 ? mix(SCATTERING_FITS[1], SCATTERING_FITS[2], (m - 0.4) / 0.3)
        : mix(SCATTERING_FITS[2], SCATTERING_FITS[3], (m - 0.7) / 0.3);
    vec3 scaled = tau * (1.0 - phase_asymmetry) / (1.0 - SCATTERING_FITTED);
    vec3 through = (fit.x + (1.0 - fit.x) * exp(-min(fit.y * scaled, vec3(SLAB_DEEPEST)))) * fit.z
        / (scaled - (scaled - 1.0) * fit.z);
    return clamp(through, vec3(slab_direct(tau, m)), vec3(1.0));
}

vec3 scattering_reflectance(float tau, float mu) {
    return 1.0 - scattering_transmittance(tau, mu);
}

vec3 scattering_diffuse_reflectance(float tau) {
    vec3 thick = 0.75 * (1.0 - phase_asymmetry) * tau;
    return thick / (1.0 + thick);
}

// Fluxes of order 1 and order 2 on one side: number 0 the sunlit one, 1 the other.
vec3 scattering_known(Slab s, float number) {
    float met = slab_met(s.optical_depth, s.mu_sun);
    vec3 once = textureLod(scattering_fluxes, slab_flux_place(number, s.optical_depth, s.mu_sun), 0.0).rgb;
    vec3 twice = textureLod(scattering_fluxes, slab_flux_place(number + 2.0, s.optical_depth, s.mu_sun), 0.0).rgb;
    return met * (once + met * twice);
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
    vec3 left = scattering_reflectance(s.optical_depth, s.mu_sun) - scattering_known(s, 0.0);
    return scattering_chosen(vec3(0.0), phase_value(s.cosine) * slab_first_up(s, vec3(1.0)),
                             phase_twice(s.cosine) * slab_second_up(s), max(left, 0.0) * s.mu_sun * slab_exit(s.mu_view));
}

vec3 scattering_down(Slab given) {
    Slab s = slab_safe(given);
    float path = min(s.optical_depth / s.mu_sun, SLAB_DEEPEST);
    vec3 met = phase_forward * path;
    vec3 peak = exp(-(1.0 - phase_forward) * path) * slab_three_or_more(met);
    vec3 around = peak * slab_glow(s.cosine, phase_spread, 3.0 + met * met / (met + 4.0));
    vec3 left = scattering_transmittance(s.optical_depth, s.mu_sun) - slab_direct(s.optical_depth, s.mu_sun)
        - scattering_known(s, 1.0) - peak;
    return scattering_chosen(around, phase_value(s.cosine) * slab_first_down(s, vec3(1.0)),
                             phase_twice(s.cosine) * slab_second_down(s), max(left, 0.0) * s.mu_sun * slab_exit(s.mu_view));
}

// Light that leaves on the sunlit side (up) or on the other.
vec3 scattering_leaving(Slab s, bool up) {
    return up ? scattering_up(s) : scattering_down(s);
}
