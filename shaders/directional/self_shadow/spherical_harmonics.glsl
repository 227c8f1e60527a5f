// A shadow hemisphere by spherical harmonics, fitted to it. Ramamoorthi & Hanrahan 2001; Sloan, Kautz & Snyder 2002.
//
// Symbols: Y_l^m <-> polynomials of the local direction without their factors, which are in the quantiser:
// coefficient k = self_shadow_ranges[k].x + code * self_shadow_ranges[k].y.
// renderer/directional/codes/spherical_harmonics.py has the twin. No claim: it rings at the edges of shadows; it is clamped.

const int SPHERICAL_BITS = SELF_SHADOW_SIZE == 5 || SELF_SHADOW_SIZE == 33 ? 10 : 8;

float spherical_coefficient(uint point, int k) {
    float code = float(shadow_field(point, k * SPHERICAL_BITS, SPHERICAL_BITS));
    return self_shadow_ranges[k].x + code * self_shadow_ranges[k].y;
}

vec4 spherical_four(uint point, int k) {
    return vec4(spherical_coefficient(point, k), spherical_coefficient(point, k + 1), spherical_coefficient(point, k + 2),
                spherical_coefficient(point, k + 3));
}

float self_shadow_visibility(Surfel surfel, vec3 towards) {
    vec3 d = shadow_local(surfel, towards);
    float x = d.x, y = d.y, z = d.z, xx = x * x, yy = y * y, zz = z * z;
    uint p = surfel.index;
    float lit = dot(spherical_four(p, 0), vec4(1.0, y, z, x));
#if SELF_SHADOW_SIZE > 5
    lit += dot(spherical_four(p, 4), vec4(x * y, y * z, 3.0 * zz - 1.0, x * z)) + spherical_coefficient(p, 8) * (xx - yy);
#endif
#if SELF_SHADOW_SIZE > 9
    lit += dot(spherical_four(p, 9), vec4(y * (3.0 * xx - yy), x * y * z, y * (5.0 * zz - 1.0), z * (5.0 * zz - 3.0)));
    lit += dot(spherical_four(p, 12).yzw, vec3(x * (5.0 * zz - 1.0), z * (xx - yy), x * (xx - 3.0 * yy)));
#endif
#if SELF_SHADOW_SIZE > 17
    lit += dot(spherical_four(p, 16), vec4(x * y * (xx - yy), y * z * (3.0 * xx - yy), x * y * (7.0 * zz - 1.0),
                                           y * z * (7.0 * zz - 3.0)));
    lit += dot(spherical_four(p, 20), vec4(35.0 * zz * zz - 30.0 * zz + 3.0, x * z * (7.0 * zz - 3.0),
                                           (xx - yy) * (7.0 * zz - 1.0), x * z * (xx - 3.0 * yy)));
    lit += spherical_coefficient(p, 24) * (xx * (xx - 3.0 * yy) - yy * (3.0 * xx - yy));
#endif
    return z > 0.0 ? clamp(lit, 0.0, 1.0) : 0.0;
}
