// Radiance along a ray through the forest: the geometry slot finds where, the others what light leaves there.
// Symbols: origin, direction the ray [m, unit]; start where it may begin [m], -1 past the scene; jitter in [0, 1)^4: the start of the walk, the levels of light, the mip level, the voxel.

// Offset in atlas coordinates that makes the mean of nearest voxels the trilinear interpolation of the level: a box one voxel wide.
vec3 voxel_shift(vec4 jitter, float level) {
    vec3 random = fract(vec3(jitter.w, jitter.w * 5.0 + jitter.z, jitter.w * 11.0 + jitter.y));
    return (random - 0.5) * exp2(level) * vec3(voxel_size / (4.0 * tile_side), voxel_size / (4.0 * tile_side), voxel_size / canopy_height);
}

vec4 forest_radiance(vec3 origin, vec3 direction, float start, vec4 jitter) {
    float t = canopy_entry(origin, direction, start);
    float footprint = max(t, 0.0) * pixel_angle + pixel_width;
    Events events = no_events(floor(filter_level(footprint) + jitter.z), jitter.y);
    vec3 shift = voxel_shift(jitter, events.level);
    if (t >= 0.0) geometry_trace(origin, direction, t, jitter.x, shift, events);
    vec3 radiance = vec3(0.0);
    for (int k = 0; k < LIGHT_EVENTS; k++) {
        float reached = events.place[k].w == NOTHING ? 0.0 : 1.0 / float(LIGHT_EVENTS);
        radiance += reached * outgoing(events.place[k], events.voxel[k], shift, events.level);
    }
    return vec4(radiance, events.opacity);
}
