// Transmittance functions of the voxels. Sloan, Hall, Hart & Snyder 2003, section 4 (principal components of what reaches a point).
// Symbols: shadow_shares transmittance towards the sun's azimuth at four elevations over the slope around the sun's own; phi the sun's
// elevation over the slope [rad]; climb its tangent; T transmittance, tau = -ln T; run horizontal part of the sun's unit vector.
// Where the layer rises towards the sun, tau = tau(phi) cos phi / run: the horizontal way is the same, its length along the ray not.
// Deviations: the functions are resolved for the sun before the frame; the layer's slope along the ray is one number.
// The neighbours are the atlas' own, not the map's; a thinned stand and a glade's edge dim by the share of trees that stand.
// Does not claim the shadow of a single tree on a glade: there the stand's edge casts it whole, as opaque as the land.

#include "forest/land_shadow.glsl"

// Farthest [m] that a ray is followed to the canopy's top.
const float WAY_OUT = 300.0;

// Lowest and highest elevation [rad] that the frame keeps for a sun; the others lie between them, each the same ratio apart.
vec2 kept_elevations(float elevation) {
    float lowest = max(max(elevation - 0.42, 0.3 * elevation), 0.035);
    return vec2(lowest, max(min(elevation + 0.5, 1.48), 2.0 * lowest));
}

float shadow_visibility(vec3 position, float h, vec2 uv) {
    float run = max(length(sun_direction.xy), 1e-4);
    float above = h * layer_height(position.xy);
    vec3 normal = ground_normal(position.xy);
    float climb = (sun_direction.z + dot(normal.xy, sun_direction.xy) / max(normal.z, 0.05)) / run;
    vec2 kept = kept_elevations(sun_elevation);
    float place = clamp(3.0 * log(max(atan(climb), 0.001) / kept.x) / log(kept.y / kept.x), 0.0, 3.0);
    vec4 shares = textureLod(shadow_shares, layered(vec3(uv, h), position.xy, float(textureSize(shadow_shares, 0).z)), 0.0);
    float transmitted = dot(shares, max(1.0 - abs(place - vec4(0.0, 1.0, 2.0, 3.0)), 0.0));
    float reach = min((canopy_top - above) / max(climb, 0.01), WAY_OUT);
    vec2 halfway = position.xy + sun_direction.xy / run * min(0.5 * reach, 12.0);
    float closed = closed_share(position.xy);
    float here = min(cover_at(position.xy).x / closed, 1.0);
    float stand = 0.5 * (here + min(cover_at(halfway).x / closed, 1.0));
    float stretched = 1.0 / (run * sqrt(1.0 + climb * climb));
    // A ray from a glade meets the trees around it as the land's shadow has them; one from a stand has met them on its way out.
    float land = over_land(position + here * max(reach, 0.0) / run * sun_direction);
    return land * mix(1.0, pow(max(transmitted, 1e-4), stand * stretched), shadow_strength);
}
