// Light above the horizon of its azimuth. Max 1988 (horizon maps); errata 003-5.
//
// Symbols: H(azimuth) <-> dark rows of a sector, blended between two; elevation of the light <-> place.x, in rows.
// No claim: what hangs over a point counts as a wall below it.

float self_shadow_visibility(Surfel surfel, vec3 towards) {
    vec3 local = shadow_local(surfel, towards);
    int sectors = min(SELF_SHADOW_SIZE == 5 ? 8 : (SELF_SHADOW_SIZE == 9 ? 16 : 32), self_shadow_azimuths);
    float lit = ring_visibility(surfel.index, shadow_place(local), sectors);
    return local.z > 0.0 ? lit : 0.0;
}
