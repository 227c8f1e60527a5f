// Coarser voxels hide by the direction in which they are looked through. Formulas b3, after Dufort 2005, section 5.3.2; Heitz, Dupuy,
// Crassin and Dachsbacher 2015, "The SGGX microflake distribution", equation 2.
//
// Symbols: the paper's w, direction of the ray, squared by axes <-> way_shares [-]; its S, of half axes along u, v and w <-> along, the
// extinctions along them (1/m); sigma(w) = sqrt(w^T S w). Level as in mipmap.glsl.
// Deviations: the axes are the texture's own, so that three numbers do for the matrix; colours are those of the light from above.

float filter_level(float distance, mat3 gradients) {
    return footprint_level(distance, gradients, filter_bias);
}

float filter_extinction(float own, vec3 place, float level) {
    vec2 stored = textureLod(filter_beside, place, level).xy;
    vec3 along = vec3(matter_stored(stored.x), matter_stored(stored.y), own);
    return sqrt(dot(way_shares, along * along));
}
