// A measured reflectance lit by sun and lamp. Porquet 2005, section 3.3.2.2.
//
// Symbols: table_reflectance [sr-1] of view and light in the point's frame (tangent, bitangent, normal); irradiances
// [W m-2]; light_ambient (1), share of the sky's light, returned as matt matter of the point's colour does.

vec3 light_local(Surfel surfel, vec3 direction) {
    return vec3(dot(direction, surfel.tangent), dot(direction, surfel.bitangent), dot(direction, surfel.normal));
}

vec3 light_radiance(Surfel surfel, vec3 to_eye) {
    vec3 view = light_local(surfel, to_eye), towards, lamp = lamp_irradiance(surfel, towards);
    vec3 sum = light_ambient * ambient_radiance(surfel);
    sum += sun_arriving(surfel) * table_reflectance(view, light_local(surfel, sun_direction));
#if LAMP_LIT
    sum += lamp * table_reflectance(view, light_local(surfel, towards));
#endif
    return sum;
}
