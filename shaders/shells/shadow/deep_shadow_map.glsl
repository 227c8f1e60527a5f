// How much of the sun is left at each depth, from a map that keeps a curve a texel. Lokovic and Veach 2000, "Deep Shadow Maps".
//
// Deviations: steps of the share that is left stand for the paper's curve of any number of nodes, so that no texel needs another's
// memory; one texel is read, at a place that differs from sample to sample, whose mean over samples is the filter; the opaque surface
// keeps its own share, and its slope, so that it does not shade itself.
// Symbols: the paper's V(z), the visibility function <-> shadow_visibility [-]; its depth z <-> along the sun's ray [m]; its filter's
// width <-> shadow_softness [px].

float shadow_visibility(vec3 point) {
    return deep_share(point, shadow_bias * shadow_texel, shadow_softness);
}
