// The shadow of land and stands for rays that have left the canopy. Dozier, Bruno & Downey 1981; renderer/forest/land_shadow.py.
// Symbols: shadow_land height [m] of the shadow's upper side at the terrain's nodes, swept for the sun.
// Does not claim a penumbra: the truth's sun is a point. The edge is rounded because a stand's tops differ by some metres, and because
// the heights between nodes are guessed; by no more than the shadow of level land falls below it in half a cell, or that would dim.

// Whether a ray that has left the canopy at p passes over the land: it must lie above the shadow's upper side.
// Beyond the square the ray is followed to where it enters it; what stands outside casts nothing.
float over_land(vec3 p) {
    float half_side = 0.5 * terrain_cell * (terrain_nodes - 1.0);
    vec2 to_side = (abs(p.xy) - half_side) * -sign(p.xy * sun_direction.xy) / max(abs(sun_direction.xy), 1e-6);
    vec2 outside = step(half_side, abs(p.xy));
    vec3 q = p + max(max(outside.x * to_side.x, outside.y * to_side.y), 0.0) * sun_direction;
    float misses = step(half_side + 1.0, max(abs(q.x), abs(q.y)));
    float shade = textureLod(shadow_land, terrain_coordinate(q.xy), 0.0).r;
    float round_by = clamp(0.5 * terrain_cell * tan(sun_elevation), 0.5, 2.0);
    return max(misses, smoothstep(-round_by, round_by, q.z - shade)) * step(0.0, sun_elevation);
}
