// Sky light by the pattern's ambient share. Cohen 2004, section 2.1 (ambient colour kept per voxel).
// Symbols: ambient share of the sky's hemisphere seen by the voxel [0, 1]; sky_irradiance W/m2, horizontal.
// Deviation: the share multiplies the physical sky instead of a constant colour. It does not know which part of the sky is hidden.

Skylight sky_light(Spot spot) {
    return even_sky(sky_irradiance * spot.ambient);
}
