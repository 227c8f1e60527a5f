// A mirror of the surroundings over what they send to matt matter. Blinn & Newell 1976; Porquet 2005, section 3.3.2;
// Ramamoorthi & Hanrahan 2001.
//
// Symbols: light_diffuse, light_specular, shares (1); light_level, of the picture's pyramid; irradiance over pi of the
// point's colour, by openness; radiance of the mirrored direction, by the point's own shadow there.

vec3 light_radiance(Surfel surfel, vec3 to_eye) {
    return environment_returned(surfel, to_eye, light_diffuse, light_specular, light_level);
}
