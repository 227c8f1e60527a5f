// Apparent thickness of a flat slab. Bouthors, Neyret and Lefebvre 2006; Belcour 2009, section 4.2.4.
//
// Symbols: h thickness (m); cos = mu, cosine (-), cosine of the ray to the outward normal where it meets the layer.
// h / cos: a ray that grazes the layer has a path that grows without end, where the sphere's ends at 36 km for 100 m.
// Deviations: where a ray meets the layer is still found on the sphere, or there would be no horizon; a path is no longer than
// FLAT_LONGEST, or a division by zero would follow.

const float FLAT_LONGEST = 1.0e9; // m

float geometry_leg(Path path, int leg, float base, float thickness, float cosine, float end) {
    vec4 legs = layer_legs(path, base, base + thickness, end);
    vec4 uncut = layer_legs(path, base, base + thickness, NEVER);
    vec2 length = leg == 0 ? vec2(legs.y, uncut.y) : vec2(legs.w, uncut.w);
    // A camera inside the layer sees the part of it that lies ahead; what the ground cuts off is cut off here too.
    float ahead = path.along < 0.0 ? path.altitude - base : base + thickness - path.altitude;
    bool inside = path.altitude > base && path.altitude < base + thickness && legs[2 * leg] == 0.0;
    float height = (inside ? ahead : thickness) * length.x / max(length.y, 1.0e-20);
    return length.x > 0.0 ? min(height / max(abs(cosine), 1.0e-20), FLAT_LONGEST) : 0.0;
}

float geometry_slant(float mu, float base, float thickness) {
    return min(thickness / max(abs(mu), 1.0e-20), FLAT_LONGEST);
}
