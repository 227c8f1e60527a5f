// Radiance along a ray through the forest: the geometry slot finds where, the others what light leaves there.
// Symbols: origin, direction the ray [m, unit]; start where it may begin [m], -1 past the scene; jitter in [0, 1)^4: the start of the walk, the levels of light, the mip level, the voxel.

vec4 forest_radiance(vec3 origin, vec3 direction, float start, vec4 jitter) {
    float t = canopy_entry(origin, direction, start);
    Events events = no_events(jitter.y);
    if (t >= 0.0) geometry_trace(origin, direction, t, jitter, events);
    vec3 radiance = vec3(0.0);
    for (int k = 0; k < LIGHT_EVENTS; k++) {
        float reached = events.place[k].w == NOTHING ? 0.0 : 1.0 / float(LIGHT_EVENTS);
        float level = level_at(dot(events.place[k].xyz - origin, direction), jitter.z);
        radiance += reached * outgoing(events.place[k], events.voxel[k], level);
    }
    return vec4(radiance, events.opacity);
}
