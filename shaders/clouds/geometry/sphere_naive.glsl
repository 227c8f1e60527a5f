// Apparent thickness of the layer on the sphere, in plain float32. Belcour 2009, section 4.2.1; errata 001-2.
//
// Symbols: H1, H2 = planet_radius + base, + base + thickness; mu cosine of the ray to the outward normal at the base.
// H_v = sqrt(H2^2 - H1^2 (1 - mu^2)) - H1 mu, and roots of the ray's quadratic with |q|^2 - H^2 as it stands: squares near 4e13 m2
// are rounded to 4e6 m2, so a layer is thick or thin by chance. `rounded` keeps a compiler from doing better.
// Deviations: a ray's nearest distance to the centre is that of path.glsl, rounded once; where a ray meets the layer is still found
// without cancellation, or the picture would be noise.

float geometry_leg(Path path, int leg, float base, float thickness, float cosine, float end) {
    float low = planet_radius + base, high = low + thickness, away = planet_radius + path.altitude;
    float lowest = rounded(rounded(away * away) - rounded(path.along * path.along));
    float outer = sqrt(max(rounded(high * high) - lowest, 0.0)), inner = sqrt(max(rounded(low * low) - lowest, 0.0));
    vec2 ends = (leg == 0 ? vec2(-outer, -inner) : vec2(inner, outer)) - path.along;
    return max(min(ends.y, end) - max(ends.x, 0.0), 0.0);
}

float geometry_slant(float mu, float base, float thickness) {
    float low = planet_radius + base, high = low + thickness;
    float square = rounded(high * high) - rounded(rounded(low * low) * (1.0 - mu * mu));
    return max(sqrt(max(square, 0.0)) - rounded(low * mu), 1.0e-3);
}
