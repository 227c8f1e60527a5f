// Double horizon maps. Cohen 2004, section 3.1, Gamma(l); weights corrected by errata 000-1, threshold by 000-2.
// Symbols: Gamma_top, Gamma_low horizon elevations [rad] at the sun's azimuth; w weight of the top map; h_low, h_top heights of the
// probes (the treetops of a stand lie below the layer's top).
// Deviations: elevation is measured from the horizontal everywhere, not from the ground's tangent plane; the terrain's
// horizon (with the stands' tops) and the tile's (under trees only) are kept apart and the higher counts, so that resolution costs a
// tile's memory; sector axes are blended before the frame.
// Section 3.2's variant in the place of empirical shading: shadow_bound 1.5 (the upper bound of C) and shadow_floor_low 90 degrees (low
// angles "at 90": the lower layers always dark). With a bound above 1 the result is a coefficient of light, no longer a share of the sun.
// Blind to gaps under crowns: one angle per sector and height.

#include "forest/horizon_threshold.glsl"

// Gamma = w Gamma_top + (1 - w) Gamma_low, w = clamp((h - h_low) / (h_top - h_low), 0, 1): errata 000-1, where h_top is 1.
float shadow_visibility(vec3 position, float h, vec2 uv) {
    float stand_here = stand_towards_sun(position.xy);
    vec2 canopy = textureLod(shadow_canopy, stacked(uv, position.xy, vec2(textureSize(shadow_canopy, 0))), 0.0).rg * stand_here;
    float w = clamp((h - shadow_low) / (shadow_top - shadow_low), 0.0, 1.0);
    float land = textureLod(shadow_terrain, terrain_coordinate(position.xy), 0.0).r;
    float low = max(canopy.g, shadow_floor_low * stand_here);
    float lit = horizon_visibility(land, mix(low, canopy.r, w), shadow_softness, shadow_strength);
    return mix(1.0, shadow_bound, stand_here) * lit;
}
