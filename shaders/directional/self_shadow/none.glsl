float self_shadow_visibility(Surfel surfel, vec3 towards) {
    return step(0.0, dot(towards, surfel.normal));
}
