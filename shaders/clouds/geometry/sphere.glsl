// Apparent thickness of the layer on the sphere. Belcour 2009, section 4.2; formulas a8; errata 001-1, 001-2, 001-4.
//
// Symbols: H1, H2 = planet_radius + base, + base + thickness; mu cosine of the ray to the outward normal AT THE BASE.
// H_v = sqrt(H2^2 - H1^2 (1 - mu^2)) - H1 mu = h (H1 + H2) / (root + H1 mu): without cancellation.
// Deviations: printed without the factor 2 where a ray crosses the shell twice, and with the wrong angle below the clouds.

float geometry_leg(Path path, int leg, float base, float thickness, float cosine, float end) {
    vec4 legs = layer_legs(path, base, base + thickness, end);
    return leg == 0 ? legs.y : legs.w;
}

float geometry_slant(float mu, float base, float thickness) {
    float low = planet_radius + base;
    float square = thickness * (2.0 * low + thickness);
    return square / max(sqrt(square + low * low * mu * mu) + low * mu, 1.0e-20);
}
