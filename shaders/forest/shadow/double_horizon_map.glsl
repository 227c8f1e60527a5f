// Double horizon maps. Cohen 2004, section 3.1, Gamma(l); weights corrected by errata 000-1, threshold by 000-2.
// Symbols: Gamma_top, Gamma_low horizon elevations [rad] at the sun's azimuth; w weight of the top map; h_low height of the low probes.
// Deviations: elevation is measured from the horizontal everywhere, not from the ground's tangent plane; terrain and tile horizons
// are kept apart and the higher counts, so that resolution costs a tile's memory; sector axes are blended before the frame.
// Blind to gaps under crowns: one angle per sector and height.

#include "forest/horizon_threshold.glsl"

// Gamma = w Gamma_top + (1 - w) Gamma_low, w = clamp((h - h_low) / (1 - h_low), 0, 1): errata 000-1.
float shadow_visibility(vec3 position, float h, vec2 uv) {
    vec2 canopy = texture(shadow_canopy, uv).rg;
    float w = clamp((h - shadow_low) / (1.0 - shadow_low), 0.0, 1.0);
    float gamma = max(mix(canopy.g, canopy.r, w), texture(shadow_terrain, terrain_coordinate(position.xy)).r);
    return mix(1.0, horizon_lit(gamma, sun_elevation, shadow_softness), shadow_strength);
}
