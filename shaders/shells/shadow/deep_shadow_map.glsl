// How much of the sun is left at each depth, from a map that keeps a curve a texel. Lokovic and Veach 2000, "Deep Shadow Maps".
//
// Deviations: steps of the share that is left stand for the paper's curve of any number of nodes, so that no texel needs another's
// memory; one texel is read, at a place that differs from sample to sample, whose mean over samples is the filter; the opaque surface
// keeps its own share, and its slope, so that it does not shade itself.
// Symbols: the paper's V(z), the visibility function <-> shadow_visibility [-]; its depth z <-> along the sun's ray [m]; its filter's
// width <-> shadow_softness [px]. Nearer than shadow_reach [px], where texels are too wide to tell a surface from what lies before it,
// matter itself is asked, closer and closer to the place, as if its cell went on.

const float SHADOW_THIN = 0.5; // optical depth, from where on matter is asked

float shadow_visibility(vec3 point) {
    float reach = 0.0, depth = 0.0;
#if SHADOW_CLOSE > 0
    reach = tet_here < 0 ? 0.0 : shadow_reach * shadow_texel;
    vec3 from = way_from + (point - way_point) * way_gradients, along = reach * (sun_direction * way_gradients);
    float level = floor(filter_level(length(point - camera_origin), way_gradients) + 0.5);
    int k = 0;
    do {
        float middle = (float(k) + 0.5) / float(SHADOW_CLOSE);
        vec3 place = from + middle * middle * along;
        float extinction = filter_extinction(matter_stored(coded_at(place, level).number), place, level);
        extinction *= step(0.0, place.z) * step(place.z, 1.0);
        depth += extinction * 2.0 * middle * reach / float(SHADOW_CLOSE);
        // What is thin where it is lit has no side that is darker than the map tells.
        bool thin = k == 0 && extinction * reach < SHADOW_THIN;
        reach = thin ? 0.0 : reach;
        depth = thin ? 0.0 : depth;
        k++;
    } while (k < SHADOW_CLOSE && reach > 0.0);
#endif
    return exp(-depth) * deep_share(point + reach * sun_direction, shadow_bias * shadow_texel, shadow_softness);
}
