// A shadow hemisphere from all of its harmonics, in full precision. Porquet 2005, section on self-shadowing.
//
// Symbols: f(a, b) = sum of all waves = sum of bits, each times the packet of its azimuth and of its row,
// D(x) = sin(pi x) / (N tan(pi x / N)): the same sum in another order, so that 17 bytes hold 129 coefficients exactly.
// renderer/directional/codes/exact_harmonics.py has the twin. No claim: between directions it rings, and is clamped.

float exact_packet(float x, float count) {
    float turned = x / count - floor(x / count + 0.5);
    float angle = 0.5 * TURN * turned;
    // Near 0 the quotient loses its digits; there the packet is 1 within 1e-6.
    float wave = sin(count * angle) * cos(angle) / (count * sin(abs(turned) < 1e-4 ? 1.0 : angle));
    return abs(turned) < 1e-4 ? 1.0 : wave;
}

float self_shadow_visibility(Surfel surfel, vec3 towards) {
    vec3 local = shadow_local(surfel, towards);
    vec2 place = shadow_place(local);
    int count = self_shadow_azimuths * self_shadow_elevations;
    float row = clamp(place.x - 0.5, 0.0, float(self_shadow_elevations - 1));
    float lit = 0.0;
    for (int i = 0; i < self_shadow_elevations; i++) {
        float along = 0.0;
        for (int j = 0; j < self_shadow_azimuths; j++) {
            int number = i * self_shadow_azimuths + j;
            float bit = float((shadow_word(surfel.index, number >> 5) >> uint(number & 31)) & 1u);
            along += bit * exact_packet(place.y - float(j), float(self_shadow_azimuths));
        }
        lit += along * exact_packet(row - float(i), float(self_shadow_elevations));
    }
    float zenith = float((shadow_word(surfel.index, count >> 5) >> uint(count & 31)) & 1u);
    lit = mix(lit, zenith, shadow_zenith(place));
    return local.z > 0.0 ? clamp(lit, 0.0, 1.0) : 0.0;
}
