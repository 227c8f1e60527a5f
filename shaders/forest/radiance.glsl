// Radiance along a ray through the forest: the geometry slot finds where, the others what light leaves there.
// Symbols: origin, direction the ray [m, unit]; start where it may begin [m], -1 past the scene; jitter in [0, 1)^4: the start of the walk, the levels of light, the mip level, the voxel.

vec4 forest_radiance(vec3 origin, vec3 direction, float start, vec4 jitter) {
    float t = canopy_entry(origin, direction, start);
    Event event = no_event(jitter.y);
    if (t >= 0.0) geometry_trace(origin, direction, t, jitter, event);
    float reached = event.place.w == NOTHING ? 0.0 : 1.0;
    float level = level_at(dot(event.place.xyz - origin, direction), jitter.z);
    return vec4(reached * outgoing(event.place, event.voxel, level), event.opacity);
}
