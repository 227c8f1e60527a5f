// Lafortune's lobe, one isotropic lobe a voxel. Lafortune, Foo, Torrance & Greenberg 1997; Cohen 2004, sections 6.1 to 6.5.
// Symbols: n matter.normal on the eye's side; s sun_direction; v to_eye; Cxy, Cz, p (the thesis' n), a in light_lobe, as shares of their
// range (renderer/forest/lobe.py), or light_cxy, light_cz, light_n everywhere; rho matter.albedo, tau matter.passed [-].
// Deviations: the formula, not the listing (errata 000-4); over pi, so that the thesis' coefficients keep energy (000-5); a is a share of
// the leaves' own colour; what leaves let through is the same lobe about the other side, which thin sheets obey exactly.
// One lobe has one normal: it does not claim the leaves that face everywhere, only the nearest lobe to them.

// Section 6.1: a + D max(0, Cxy s.v + (Cz - Cxy)(s.n)(n.v))^p, D = max(s.n, 0); with -s for s the sign of both changes.
vec3 light_reflected(Matter matter, vec3 to_eye) {
    vec4 stored = textureLod(light_lobe, matter.place, matter.level);
    vec4 own = vec4(stored.xy * 3.0 - 1.5, 0.02 + 3.98 * stored.z * stored.z, 0.5 * stored.w);
    vec4 lobe = mix(vec4(light_cxy, light_cz, light_n, 0.0), own, light_stored);
    float seen = dot(matter.normal, to_eye);
    float lit = dot(matter.normal, sun_direction) * (seen < 0.0 ? -1.0 : 1.0);
    float inner = lobe.x * dot(sun_direction, to_eye) + (lobe.y - lobe.x) * lit * abs(seen);
    float power = abs(lit) * pow(max(abs(inner), 1e-6), lobe.z);
    float front = lobe.w + (lit > 0.0 && inner > 0.0 ? power : 0.0);
    float behind = lobe.w + (lit < 0.0 && inner < 0.0 ? power : 0.0);
    return INVERSE_PI * (front * matter.albedo + behind * matter.passed);
}
