// Plane layers by doubling, read from tables. van de Hulst 1963; Hansen 1971; delta-M: Wiscombe 1977; order 1 kept exact:
// Nakajima & Tanaka 1988; glow of the forward peak: formulas a3.
// Symbols: f peak scattering_peak [-], taken out of the phase function P [1/sr]; tau' = (1 - f) tau; the azimuthal orders of light
// of two orders and more are stored over a share that carries thin layers and grazing directions.
// Deviations: order 1 of the scaled layer has the true P; a factor makes of it, around the sun on the other side, order 1 of the true
// layer, what the peak leaves of P in the scaled one, and the glow of two deflections and more; behind, on the sunlit side, it
// blurs fogbow and glory by the peak.
// Does not claim: the glow's skewness at grazing view; azimuthal orders beyond 8 of light of two orders and more.

#include "clouds/angles.glsl"
#include "clouds/slab.glsl"

const float SCATTERING_GLOW_LEAST = -4.0;
const float SCATTERING_GLOW_STEP = 2.0; // entries for each doubling of the path
const float SCATTERING_GLOW_PATHS = 21.0;
const float SCATTERING_ENTRIES = 2048.0; // angles from 0 to 180 degrees
const float SCATTERING_FORWARD = 0.9961946980917455; // cosine of 5 degrees

// How light of two orders and more goes with a thin layer and with grazing directions.
float scattering_share(Slab s) {
    float a = s.optical_depth * (1.0 / s.mu_sun + 1.0 / s.mu_view);
    float met = a / (1.0 + a);
    return met * met * s.mu_sun / (s.mu_sun + s.mu_view);
}

// cos(m phi) for m from 1 to 8, by Chebyshev's recurrence.
void scattering_turns(float c, out vec4 low, out vec4 high) {
    float c2 = 2.0 * c * c - 1.0;
    float c3 = 2.0 * c * c2 - c;
    float c4 = 2.0 * c2 * c2 - 1.0;
    float c5 = 2.0 * c2 * c3 - c;
    low = vec4(c, c2, c3, c4);
    high = vec4(c5, 2.0 * c3 * c3 - 1.0, 2.0 * c3 * c4 - c, 2.0 * c4 * c4 - 1.0);
}

vec3 scattering_direct(float tau, float mu) {
    return vec3(slab_direct(tau, mu));
}

vec3 scattering_reflectance(float tau, float mu) {
    float plain = tau / (tau + 7.0 * max(mu, SLAB_GRAZING));
    return textureLod(scattering_flux, slab_place(tau, mu), 0.0).rgb * plain;
}

vec3 scattering_transmittance(float tau, float mu) {
    return 1.0 - scattering_reflectance(tau, mu);
}

vec3 scattering_diffuse_reflectance(float tau) {
    return textureLod(scattering_even, vec2(slab_place(tau, 1.0).y, 0.5), 0.0).rgb * (tau / (tau + 7.0));
}

// What the forward peak makes of order 1: a glow around the sun, by the mean path, or a blur behind, by the path in and out.
vec3 scattering_peak_factor(Slab s, bool up) {
    float path = s.optical_depth * (up ? 1.0 / s.mu_sun + 1.0 / s.mu_view : inversesqrt(s.mu_sun * s.mu_view));
    float row = clamp((log2(max(path, 1e-6)) - SCATTERING_GLOW_LEAST) * SCATTERING_GLOW_STEP, 0.0, SCATTERING_GLOW_PATHS - 1.0);
    float column = angle_place(s.cosine) * (SCATTERING_ENTRIES - 1.0);
    vec2 place = vec2((column + 0.5) / SCATTERING_ENTRIES, (row + 0.5) / SCATTERING_GLOW_PATHS);
    return (s.cosine <= 0.0) == up ? textureLod(scattering_glow, place, 0.0).rgb : vec3(1.0);
}

// Light that leaves on the sunlit side (up) or on the other, with one look at each table for both.
vec3 scattering_leaving(Slab given, bool up) {
    Slab s = slab_safe(given);
    vec3 place = slab_place(s);
    place.z = 0.5 * (up ? place.z : place.z + 1.0);
    vec4 low, high;
    scattering_turns(s.cos_azimuth, low, high);
    float turned = dot(textureLod(scattering_low, place, 0.0), low) + dot(textureLod(scattering_high, place, 0.0), high);
    float share = scattering_share(s) / (up ? 1.0 : 1.0 + 0.1 * s.optical_depth);
    vec3 more = max(textureLod(scattering_mean, place, 0.0).rgb + turned, 0.0) * share;
    vec3 P = phase_value(s.cosine);
    vec3 bright = P * slab_first(s, 1.0 - scattering_peak, up) * scattering_peak_factor(s, up);
#if SCATTERING_ORDER == SCATTERING_ORDER_ALL
    return more + bright;
#else
    vec3 single = P * slab_first(s, vec3(1.0), up);
    vec3 forward = !up && s.cosine > SCATTERING_FORWARD ? bright - single : vec3(0.0);
#if SCATTERING_ORDER == SCATTERING_ORDER_SINGLE
    return single;
#elif SCATTERING_ORDER == SCATTERING_ORDER_FORWARD
    return forward;
#else
    return more + bright - single - forward;
#endif
#endif
}

vec3 scattering_up(Slab s) {
    return scattering_leaving(s, true);
}

vec3 scattering_down(Slab s) {
    return scattering_leaving(s, false);
}
