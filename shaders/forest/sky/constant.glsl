// Constant sky. Cohen 2004, listing 10.1 (share 0.3) and listing 10.3 (vec3(0.3, 0.5, 0.6)).
// Symbols: sky_tint, sky_share [-]; sun_irradiance W/m2 normal to the beam.
// Deviation: the share is of the sun's irradiance, so that it keeps its meaning in physical units; where clouds take the sun, it is dark.

Skylight sky_light(Spot spot) {
    return even_sky(sky_tint * sky_share * sun_irradiance);
}
