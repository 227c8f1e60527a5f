// What a point receives: the sky by its openness, and a lamp at a place.
//
// Porquet 2005, sections 3.3.2.1 and 3.3.2.3: ambient light, and shadows of a point source.
// Symbols: openness, cosine-weighted share of the open hemisphere (1); irradiances [W m-2]; intensity [W sr-1].

const float SOURCES_PI = 3.14159265358979;

// Radiance [W m-2 sr-1] that matt matter of a colour returns of the sky: an even upper dome, of which a plane that is
// tilted by its normal faces the share (1 + n_z) / 2.
vec3 ambient_radiance(Surfel surfel) {
    return surfel.colour * sky_irradiance * (surfel.openness * 0.5 * (1.0 + surfel.normal.z) / SOURCES_PI);
}

// Direction to the lamp, and what arrives on a plane at the point [W m-2], shadow included.
vec3 lamp_irradiance(Surfel surfel, out vec3 towards) {
#if LAMP_LIT
    vec3 way = lamp_position - surfel.position;
    float square = max(dot(way, way), 1e-6);
    towards = way * inversesqrt(square);
    float facing = max(dot(surfel.normal, towards), 0.0);
    return lamp_colour * (lamp_intensity * facing / square * self_shadow_visibility(surfel, towards));
#else
    towards = surfel.normal;
    return vec3(0.0);
#endif
}

// What arrives of the sun on a plane at the point [W m-2], shadow included.
vec3 sun_arriving(Surfel surfel) {
    float facing = max(dot(surfel.normal, sun_direction), 0.0);
    return sun_irradiance * (facing * self_shadow_visibility(surfel, sun_direction));
}
