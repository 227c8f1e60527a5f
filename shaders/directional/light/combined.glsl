// Sun and lamp by Phong's model or a measured reflectance, and the surroundings. Porquet 2005, section 3.3.2.
//
// Symbols: light_surface_share, light_environment_share (1); of Phong light_diffuse, light_specular, light_shininess; of
// the surroundings light_matt, light_mirror (1) and light_level, of the picture's pyramid; irradiances [W m-2].

vec3 light_returned(Surfel surfel, vec3 to_eye, vec3 towards) {
#if LIGHT_SURFACE == LIGHT_SURFACE_MEASURED
    mat3 frame = mat3(surfel.tangent, surfel.bitangent, surfel.normal);
    return table_reflectance(to_eye * frame, towards * frame);
#else
    return phong_reflectance(surfel.normal, surfel.colour, towards, to_eye, light_diffuse, light_specular, light_shininess);
#endif
}

vec3 light_radiance(Surfel surfel, vec3 to_eye) {
    vec3 towards, lamp = lamp_irradiance(surfel, towards);
    vec3 sum = sun_arriving(surfel) * light_returned(surfel, to_eye, sun_direction);
#if LAMP_LIT
    sum += lamp * light_returned(surfel, to_eye, towards);
#endif
    return light_surface_share * sum
        + light_environment_share * environment_returned(surfel, to_eye, light_matt, light_mirror, light_level);
}
