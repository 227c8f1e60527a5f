// Looking a point up in a map of first sunward places. Williams 1978; Isidoro 2006 (receiver plane); Reeves, Salesin & Cook 1987.
// Symbols: sunward p . sun_direction [m], greater nearer to the sun; line a point's coordinates along shadow_right and shadow_up [m];
// bias how far behind the first matter light still arrives [m]; fade length over which it is lost behind that [m], 0 at once.

vec2 line_of(vec3 position) {
    return vec2(dot(position, shadow_right), dot(position, shadow_up));
}

// Change of the sunward coordinate per metre along shadow_right and shadow_up on the ground's plane, to which the canopy is parallel:
// a point is compared as if it stood at its texel's centre, or a slope would shade itself (Isidoro 2006).
vec2 sunward_slope(vec2 xy) {
    vec3 normal = ground_normal(xy);
    return -vec2(dot(normal, shadow_right), dot(normal, shadow_up)) / max(dot(normal, sun_direction), 0.05);
}

// Dachsbacher & Stamminger 2003: light fades with the way behind the first matter.
float past_first(float first, float sunward, float bias, float fade) {
    float behind = max(first - bias - sunward, 0.0);
    return fade > 0.0 ? exp(-behind / fade) : behind > 0.0 ? 0.0 : 1.0;
}
