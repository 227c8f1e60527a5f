// No shadow. Cohen 2004, ch. 5, Illustration 8 ("scène sans ombrage").
// Symbols: position (m, world), h normalised canopy height, uv atlas coordinates.

float shadow_visibility(vec3 position, float h, vec2 uv) {
    return 1.0;
}
