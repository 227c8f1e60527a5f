// Order 1 alone. Blinn 1982, "Light reflection functions for simulation of clouds and dusty surfaces"; Belcour 2009, section 3.2.1.
// Symbols: P phase_value [1/sr]; mu_l, mu_v cosines of sun and view [-]; tau optical depth [-]; formulas a4.
// Deviations: the measure is dl / cos of the view, and the angle that between propagation directions (errata 001-14, 001-15).
// Does not claim: energy; all light of two orders and more is left out.

#include "clouds/slab.glsl"

vec3 scattering_direct(float tau, float mu) {
    return vec3(slab_direct(tau, mu));
}

vec3 scattering_reflectance(float tau, float mu) {
    return textureLod(scattering_fluxes, slab_flux_place(0.0, tau, mu), 0.0).rgb * slab_met(tau, mu);
}

vec3 scattering_transmittance(float tau, float mu) {
    vec3 once = textureLod(scattering_fluxes, slab_flux_place(1.0, tau, mu), 0.0).rgb * slab_met(tau, mu);
    return once + slab_direct(tau, mu);
}

vec3 scattering_diffuse_reflectance(float tau) {
    return textureLod(scattering_even, vec2(slab_place(tau, 1.0).y, 0.5), 0.0).rgb * slab_met(2.0 * tau, 1.0);
}

vec3 scattering_up(Slab given) {
    Slab s = slab_safe(given);
    return phase_value(s.cosine) * slab_first_up(s, vec3(1.0));
}

vec3 scattering_down(Slab given) {
    Slab s = slab_safe(given);
    return phase_value(s.cosine) * slab_first_down(s, vec3(1.0));
}

// Light that leaves on the sunlit side (up) or on the other.
vec3 scattering_leaving(Slab s, bool up) {
    return up ? scattering_up(s) : scattering_down(s);
}
