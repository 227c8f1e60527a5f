// Where a ray looks at the light: the geometry slot finds it, whatever the sun. What was traced serves while only the light changes.
// Symbols: origin, direction the ray [m, unit]; start where it may begin [m], -1 past the scene; jitter in [0, 1)^4: the start of
// the walk, the level of light, the mip level, the voxel.

Event forest_trace(vec3 origin, vec3 direction, float start, vec4 jitter) {
    float t = canopy_entry(origin, direction, start);
    Event event = no_event(jitter.y);
    if (t >= 0.0) geometry_trace(origin, direction, t, jitter, event);
    return event;
}
