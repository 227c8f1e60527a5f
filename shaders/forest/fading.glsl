// How the land ends. Outside the square nothing is known: its edge is drawn out (world.glsl), which shows as streaks and, against
// the light, as a dark band up to the horizon. So that land becomes transparent with its distance from the square, and the sky
// behind it takes its place. No model of the air: inside the square nothing fades.
// Symbols: xy position [m]; scene_fade [m], terrain_cell [m], terrain_nodes.
// Twin: `kept` in renderer/reference/forest_lookup.py.

// Share of what stands at a place that the eye sees: exp(-(d / scene_fade)^2), d the distance to the square.
float land_kept(vec2 xy) {
    vec2 out_of = max(abs(xy) - 0.5 * (terrain_nodes - 1.0) * terrain_cell, 0.0) / scene_fade;
    return exp(-dot(out_of, out_of));
}
