// The square over which bounced light is computed, and what lies beyond it. Belcour 2009, section 5.2.2; formulas a7.
// Symbols: H height of the cloud base; the square has the half side 16 H = bounce_half [m] around bounce_centre [m]; R reflectance
// of the base and rho albedo of the ground; between endless uniform planes all bounces add R rho / (1 - R rho) of the first light.
// Deviations: near the square's edge the light fades to that of endless planes that are everywhere as they are at the place.

#include "clouds/bounce_here.glsl"

// Place in the square, -1 to 1.
vec2 bounce_at(vec2 place) {
    return (place - bounce_centre) / bounce_half;
}

// Share of the square's own light: 1 in its middle, 0 from its edge on.
float bounce_within(vec2 at) {
    vec2 d = abs(at);
    return 1.0 - smoothstep(0.7, 0.95, max(d.x, d.y));
}

vec3 bounce_product(BounceHere here) {
    return min(here.albedo * here.reflectance, vec3(0.98));
}

// Endless uniform planes: light added to the ground, and to the base.
vec3 bounce_even_ground(BounceHere here) {
    vec3 product = bounce_product(here);
    return here.irradiance * product / (1.0 - product);
}

vec3 bounce_even_cloud(BounceHere here) {
    return here.irradiance * here.albedo / (1.0 - bounce_product(here));
}
