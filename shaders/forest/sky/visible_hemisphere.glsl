// Sky light by the visible hemisphere. Dozier & Frew 1990, eq. 7 (the sky above a horizon); Ramamoorthi & Hanrahan 2001 (light as a low
// polynomial of the direction).
// Symbols: w direction, z up, s level and towards the sun, t level and across; L the sky's radiance, V what trees and land let through.
// Texels hold the integrals over the upper hemisphere of V / 2 pi and V w / pi: `sky_seen` through the trees, `sky_land` over the land.
// V of the trees is taken as c + d.w with these integrals, so that the light is c and d times moments of L:
//   sky_even L, sky_upward z L, sky_sunward s L, sky_upward2 z^2 L, sky_sunward2 s^2 L, sky_across2 t^2 L, sky_upward_sunward z s L,
//   integrated over the upper hemisphere [W/m2].
// Deviations: V is linear in the direction; the land takes from each moment what it takes of an even sky's, but on open ground; trees are the atlas' own
// neighbours, whatever the map has thinned. Seen from afar, where coarse voxels stand before the leaves, it is read in the air
// in front of them and too bright.

Skylight sky_light(Spot spot) {
    vec4 trees = textureLod(sky_seen, layered(spot.place, spot.position.xy, float(textureSize(sky_seen, 0).z)), 0.0);
    trees.yz = trees.yz * 2.0 - 1.0;
    trees = mix(vec4(1.0, 0.0, 0.0, 1.0), trees, spot.wooded);
    vec4 land = textureLod(sky_land, terrain_coordinate(spot.position.xy), 0.0);
    land.yz = land.yz * 2.0 - 1.0;
    vec2 s = sky_sun_direction.xy / max(length(sky_sun_direction.xy), 1e-6);
    vec2 t = vec2(-s.y, s.x);
    float c = 4.0 * trees.x - 3.0 * trees.w;
    float up = 6.0 * (trees.w - trees.x);
    vec2 level = 1.5 * vec2(dot(trees.yz, s), dot(trees.yz, t));
    vec2 open = vec2(dot(land.yz, s), dot(land.yz, t));
    // Of a sky that is even above a level horizon of sine x the land leaves 1 - x, 1 - x^2 and 1 - x^3 of these moments.
    float hidden = 1.0 - land.w;
    vec3 even = sky_even * land.x;
    vec3 upward = sky_upward * land.w;
    vec3 upward2 = sky_upward2 * (1.0 - hidden * sqrt(hidden));
    vec3 sunward = sky_sunward * land.x + 0.5 * open.x * sky_even;
    // On open ground the land's own c + d.w tells which part of the sky it hides; in a stand the trees hide the low sky before it.
    float high = 6.0 * (land.w - land.x);
    vec3 hides = (4.0 * land.x - 3.0 * land.w) * sky_upward + high * sky_upward2 + 1.5 * open.x * sky_upward_sunward;
    upward = mix(max(hides, 0.0), upward, spot.wooded);
    vec3 across = 0.5 * open.y * sky_even;
    vec3 aslant = sky_upward_sunward * land.w;
    vec3 whole = max(c * even + up * upward + level.x * sunward + level.y * across, 0.0);
    vec3 to_s = c * sunward + up * aslant + level.x * sky_sunward2 * land.x;
    vec3 to_t = c * across + level.y * sky_across2 * land.x;
    vec3 to_z = c * upward + up * upward2 + level.x * aslant;
    // Both sides of a leaf get half of the whole light in the mean over all leaves, and a level one just what comes down.
    return Skylight(0.5 * whole, 1.5 * (to_z - 0.5 * whole), mat3(to_s * s.x + to_t * t.x, to_s * s.y + to_t * t.y, to_z));
}
