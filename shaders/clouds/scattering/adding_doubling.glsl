// Plane layers by doubling, read from tables. van de Hulst 1963; Hansen 1971; delta-M: Wiscombe 1977; order 1 kept exact:
// Nakajima & Tanaka 1988; glow of the forward peak: formulas a3.
// Symbols: f peak scattering_peak [-], taken out of the phase function P [1/sr]; tau' = (1 - f) tau; the azimuthal orders of light
// of two orders and more are stored over a share that carries thin layers and grazing directions.
// Deviations: on the sunlit side order 1 of the scaled layer has the true P; on the other side order 1 is that of the true layer,
// the rest of P goes through the scaled one, and two deflections and more by the peak alone are a glow of their own.
// Does not claim: glory and fogbow blurred by the peak; the glow's skewness at grazing view.

#include "clouds/angles.glsl"
#include "clouds/slab.glsl"

const float SCATTERING_GLOW_LEAST = -4.0;
const float SCATTERING_GLOW_STEP = 3.2; // entries for each doubling of the path
const vec2 SCATTERING_GLOW_SIZE = vec2(512.0, 33.0);
const float SCATTERING_ENTRIES = 2048.0;

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

vec3 scattering_up(Slab given) {
    Slab s = slab_safe(given);
    vec3 kept = 1.0 - scattering_peak;
    vec3 once = slab_first_up(s, vec3(1.0));
    vec3 scaled = slab_first_up(s, kept) / kept;
    vec3 place = slab_place(s);
    vec4 low, high;
    scattering_turns(s.cos_azimuth, low, high);
    float turned = dot(textureLod(scattering_up_low, place, 0.0), low) + dot(textureLod(scattering_up_high, place, 0.0), high);
    vec3 more = max(textureLod(scattering_up_mean, place, 0.0).rgb + turned, 0.0) * scattering_share(s);
    vec3 P = phase_value(s.cosine);
    if (scattering_order == scattering_order_single) return P * once;
    if (scattering_order == scattering_order_forward) return vec3(0.0);
    return more + P * (scattering_order == scattering_order_all ? scaled : scaled - once);
}

// Two deflections and more by the forward peak alone, along the ray.
vec3 scattering_glow_around(Slab s) {
    float path = s.optical_depth * inversesqrt(s.mu_sun * s.mu_view);
    float row = clamp((log2(max(path, 1e-6)) - SCATTERING_GLOW_LEAST) * SCATTERING_GLOW_STEP, 0.0, SCATTERING_GLOW_SIZE.y - 1.0);
    float column = angle_place(s.cosine) * (2.0 * SCATTERING_GLOW_SIZE.x - 1.0);
    vec3 shape = textureLod(scattering_glow, (vec2(min(column, SCATTERING_GLOW_SIZE.x - 1.0), row) + 0.5) / SCATTERING_GLOW_SIZE,
                            0.0).rgb;
    vec3 met = scattering_peak * path;
    vec3 energy = exp(-min(path, SLAB_DEEPEST) * (1.0 - scattering_peak)) - exp(-min(path, SLAB_DEEPEST)) * (1.0 + met);
    return s.cosine > 0.0 ? shape * max(energy, 0.0) : vec3(0.0);
}

vec3 scattering_down(Slab given) {
    Slab s = slab_safe(given);
    vec3 kept = 1.0 - scattering_peak;
    vec3 once = slab_first_down(s, vec3(1.0));
    vec3 scaled = slab_first_down(s, kept) / kept;
    vec3 place = slab_place(s);
    vec4 low, high;
    scattering_turns(s.cos_azimuth, low, high);
    float turned = dot(textureLod(scattering_down_low, place, 0.0), low) + dot(textureLod(scattering_down_high, place, 0.0), high);
    vec3 more = max(textureLod(scattering_down_mean, place, 0.0).rgb + turned, 0.0) * scattering_share(s)
        / (1.0 + 0.1 * s.optical_depth);
    float column = (angle_place(s.cosine) * (SCATTERING_ENTRIES - 1.0) + 0.5) / SCATTERING_ENTRIES;
    vec3 rest = textureLod(scattering_rest, vec2(column, 0.5), 0.0).rgb * (scaled - once);
    vec3 single = phase_value(s.cosine) * once;
    vec3 glow = scattering_glow_around(s);
    if (scattering_order == scattering_order_single) return single;
    if (scattering_order == scattering_order_forward) return glow;
    return max(more + rest + (scattering_order == scattering_order_all ? single + glow : vec3(0.0)), 0.0);
}
