// A ring of horizons: how many rows of each sector of a point's hemisphere are dark. Max 1988; errata 003-5.
//
// Symbols: dark <-> field of 4 bits a sector, 15 for all rows; behind the last, the zenith's bit.
// renderer/directional/codes/horizon_ring.py has the twin.

float ring_dark(uint point, int sector) {
    uint code = shadow_field(point, 4 * sector, 4);
    return code == 15u ? float(self_shadow_elevations) : float(code);
}

// sectors: of the ring, a power of two.
float ring_visibility(uint point, vec2 place, int sectors) {
    float across = float(self_shadow_azimuths / sectors);
    float turn = (place.y - 0.5 * (across - 1.0)) / across;
    int first = int(floor(turn));
    float horizon = mix(ring_dark(point, first & (sectors - 1)), ring_dark(point, (first + 1) & (sectors - 1)),
                        turn - float(first));
    float ring = clamp(place.x - horizon + 0.5, 0.0, 1.0);
    return mix(ring, float(shadow_field(point, 4 * sectors, 1)), shadow_zenith(place));
}
