// Perspective shadow map. Stamminger & Drettakis 2002, section 3; Cohen 2004, section 5.1.
// Symbols: shadow_to_map homography of the plane across the light (from shadow_anchor, [m]) to the map: the camera's projection and,
// after it, the light's; shadow_bias [m], and shadow_texel_bias for each metre of the texel's width on the light's plane.
// Deviations: kept is the sunward coordinate in the world, not the depth after the projection, whose order turns round where the sun
// stands behind the camera.
// Fails as published: far errors grow, and every texel changes place when the camera or a sun near the view direction moves.

#include "forest/sun_map.glsl"

vec2 perspective_line(vec2 place) {
    vec3 line = shadow_to_light * vec3(place, 1.0);
    return line.xy / line.z;
}

float shadow_visibility(vec3 position, float h, vec2 uv) {
    vec2 line = line_of(position) - shadow_anchor;
    vec3 projected = shadow_to_map * vec3(line, 1.0);
    vec2 place = projected.xy / projected.z;
    float side = float(textureSize(shadow_depth, 0).x);
    vec2 texel = floor(place * side);
    vec2 centre = perspective_line((texel + 0.5) / side);
    vec2 width = max(abs(perspective_line((texel + vec2(1.5, 0.5)) / side) - centre), abs(perspective_line((texel + vec2(0.5, 1.5)) / side) - centre));
    float first = texelFetch(shadow_depth, clamp(ivec2(texel), ivec2(0), ivec2(side) - 1), 0).r;
    float sunward = dot(position, sun_direction) + dot(sunward_slope(position.xy), centre - line);
    float lit = past_first(first, sunward, shadow_bias + shadow_texel_bias * max(width.x, width.y), 0.0);
    bool outside = projected.z <= 0.0 || any(lessThan(place, vec2(0.0))) || any(greaterThan(place, vec2(1.0)));
    return sun_direction.z < 0.0 ? 0.0 : mix(1.0, outside ? 1.0 : lit, shadow_strength);
}
