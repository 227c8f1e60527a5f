// Ambient, diffuse and specular light of sun and lamp. Phong 1975; Porquet 2005, section 3.3.2; Lafortune & Willems 1994.
//
// Symbols: light_ambient, light_diffuse, light_specular (1), light_shininess; irradiances [W m-2].
// Deviations: the lobe is normalised; the ambient term is the sky's light on the open part of the hemisphere.

vec3 light_radiance(Surfel surfel, vec3 to_eye) {
    vec3 towards, lamp = lamp_irradiance(surfel, towards), sum = light_ambient * ambient_radiance(surfel);
    sum += sun_arriving(surfel) * phong_reflectance(surfel.normal, surfel.colour, sun_direction, to_eye,
                                                    light_diffuse, light_specular, light_shininess);
#if LAMP_LIT
    sum += lamp * phong_reflectance(surfel.normal, surfel.colour, towards, to_eye,
                                    light_diffuse, light_specular, light_shininess);
#endif
    return sum;
}
