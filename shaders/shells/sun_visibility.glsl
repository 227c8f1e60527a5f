// What all that stands in the scene leaves of the sun at a place: what the shell leaves, times what other meshes do.

float sun_visibility(vec3 point) {
#if THINGS == 1
    return thing_visibility(point) * shadow_visibility(point);
#else
    return shadow_visibility(point);
#endif
}
