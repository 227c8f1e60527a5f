// The soft threshold that every horizon technique shares. Cohen 2004, section 3.1, corrected by errata 000-2.
// Symbols: gamma horizon elevation [rad], phi elevation of the sun [rad], eps half width of the penumbra [rad].

// Distance [m] to the neighbouring tree, whose shadow the tile's horizon holds.
const float NEIGHBOUR = 8.0;

// Half penumbra [rad] of the land's shadow at most: the sun's radius and half a cell of the map seen from a hundred metres.
const float LAND_SOFTNESS = 0.045;

// C = t^2 (3 - 2 t), t = clamp((phi - Gamma + eps) / (2 eps), 0, 1); the printed t lacks "+ eps" (errata 000-2).
// A sun below the horizontal plane lights nothing (errata 000-10).
float horizon_lit(float gamma, float phi, float eps) {
    return smoothstep(gamma - eps, gamma + eps, phi) * step(0.0, phi);
}

// Whether the stand goes on towards the sun: a tile's horizon, which knows neither glades nor edges, counts only there.
float stand_towards_sun(vec2 xy) {
    return wooded_at(xy) * wooded_at(xy + NEIGHBOUR * normalize(sun_direction.xy + 1e-6));
}

// Elevation of the sun over the ground along its azimuth: in the canopy's frame, which is sheared with the ground, a ray rises so.
float sun_over_ground(vec2 xy) {
    vec3 normal = textureLod(normals, terrain_coordinate(xy), 0.0).xyz;
    return atan(sun_direction.z + dot(normal.xy, sun_direction.xy) / max(normal.z, 0.05), length(sun_direction.xy));
}

// Sun over the land's horizon and over the canopy's: the land hides it wholly, the canopy by its strength, for leaves let light through.
float horizon_visibility(float land, float canopy, float eps, float strength) {
    float over_land = horizon_lit(land, sun_elevation, min(eps, LAND_SOFTNESS));
    return over_land * mix(1.0, horizon_lit(canopy, sun_elevation, eps), strength);
}
