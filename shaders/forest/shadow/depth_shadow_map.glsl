// Depth shadow map. Williams 1978; Cohen 2004, section 5.1.
// Symbols: depth distance from the sun's window [m]; shadow_bias [m]; texel nearest, no filtering: the thesis' plain map.
// Knows one distance per texel: nothing of transparency. Scintillates when the sun moves; that is its failure.

float shadow_visibility(vec3 position, float h, vec2 uv) {
    vec3 relative = position - shadow_corner;
    vec2 place = vec2(dot(relative, shadow_right) / dot(shadow_right, shadow_right), dot(relative, shadow_up) / dot(shadow_up, shadow_up));
    if (any(lessThan(place, vec2(0.0))) || any(greaterThan(place, vec2(1.0))) || sun_direction.z < 0.0) return sun_direction.z < 0.0 ? 0.0 : 1.0;
    float depth = dot(relative, -sun_direction);
    float lit = depth <= textureLod(shadow_depth, place, 0.0).r + shadow_bias ? 1.0 : 0.0;
    return mix(1.0, lit, shadow_strength);
}
