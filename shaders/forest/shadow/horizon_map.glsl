// Single horizon map. Max 1988; Cohen 2004, section 3.1 (one map) and 7.2 (degraded combination).
// Symbols: Gamma horizon elevation [rad] at the sun's azimuth; phi sun_elevation [rad]; eps shadow_softness [rad].
// Deviations: elevation is measured from the horizontal everywhere, not from the ground's tangent plane; the map is split
// in a terrain part (with the stands' tops) and a tile part (under trees only), of which the higher counts; the two sector axes are blended before the frame.
// Blind to gaps under crowns: one angle per sector. One height stands for the whole canopy.

#include "forest/horizon_threshold.glsl"

float shadow_visibility(vec3 position, float h, vec2 uv) {
    float canopy = textureLod(shadow_canopy, stacked(uv, position.xy, vec2(textureSize(shadow_canopy, 0))), 0.0).r * stand_towards_sun(position.xy);
    float land = textureLod(shadow_terrain, terrain_coordinate(position.xy), 0.0).r;
    return horizon_visibility(land, canopy, shadow_softness, shadow_strength);
}
