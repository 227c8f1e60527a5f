// Horizon volume. After Max 1988 (horizon maps) and Cohen 2004, section 3.1 (several heights): K heights and M azimuths over the
// tile, beside the terrain's own horizon.
// Symbols: Gamma horizon [rad], eps half penumbra [rad] and A clear share of the canopy at the sun's azimuth, all three fitted to
// the light that reaches a probe from each elevation; phi elevation of the sun over the ground along its azimuth [rad].
// Deviations: Gamma is no angle of solid matter but that of the smoothstep which comes nearest to transmittance, so that crowns let
// light through and gaps under them count; the canopy is sheared with the ground, therefore phi is measured from it.
// Does not know: gaps that close again as the sun rises; the map's own neighbours, where the tile's are others.

#include "forest/horizon_threshold.glsl"

// What the bytes stand for: GAMMA_RANGE and SPREAD_RANGE of the bake, lowest and span [rad].
const vec4 SOFT_RANGE = vec4(-0.5235987755982988, 2.0943951023931953, 0.017453292519943295, 1.0471975511965976);

// A smoothstep((phi - Gamma + eps) / (2 eps)) at one of the heights, which are stacked in `canopy` with a row more on either side.
float soft_horizon(vec2 uv, float level, float phi) {
    vec2 size = vec2(textureSize(shadow_canopy, 0));
    float rows = size.y / (shadow_levels * float(max(SPECIES_MAP, 1)));
    float row = level * rows + 1.0 + fract(uv.y) * (rows - 2.0);
    vec3 found = textureLod(shadow_canopy, vec2(uv.x, row / size.y), 0.0).rgb;
    float gamma = SOFT_RANGE.x + SOFT_RANGE.y * found.r;
    float eps = SOFT_RANGE.z + SOFT_RANGE.w * found.g;
    return found.b * smoothstep(gamma - eps, gamma + eps, phi);
}

float shadow_visibility(vec3 position, float h, vec2 uv) {
    float phi = sun_over_ground(position.xy);
    float place = clamp(h / shadow_highest, 0.0, 1.0) * (shadow_levels - 1.0);
    float level = min(floor(place), shadow_levels - 2.0);
    float lowest = section_at(position.xy) * shadow_levels;
    float lit = mix(soft_horizon(uv, lowest + level, phi), soft_horizon(uv, lowest + level + 1.0, phi), place - level);
    float land = textureLod(shadow_terrain, terrain_coordinate(position.xy), 0.0).r;
    float over_land = horizon_lit(land, sun_elevation, LAND_SOFTNESS);
    return over_land * mix(1.0, lit, shadow_strength * stand_towards_sun(position.xy));
}
