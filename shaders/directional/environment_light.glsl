// What a point sends of the light from all directions, as a mirror and as matt matter.
//
// Porquet 2005, section 3.3.2 (environment mapping); Ramamoorthi & Hanrahan 2001, equations 8 and 13: irradiance from
// spherical harmonics, here of bands 0, 1, 2 and 4 (band 3 is nothing). Twin: renderer/directional/environment_light.py.
// Symbols: radiance W m-2 sr-1, irradiance W m-2, openness 1.

#include "directional/surroundings.glsl"

vec3 environment_irradiance(vec3 normal) {
    vec3 own = environment_own(normal), s = own * own;
    float x = own.x, y = own.y, z = own.z, across = s.x - s.y, five = 7.0 * s.z;
    vec3 sum = environment_harmonics[0];
    sum += y * environment_harmonics[1] + z * environment_harmonics[2] + x * environment_harmonics[3];
    sum += x * y * environment_harmonics[4] + y * z * environment_harmonics[5];
    sum += (3.0 * s.z - 1.0) * environment_harmonics[6] + x * z * environment_harmonics[7];
    sum += across * environment_harmonics[8];
    sum += x * y * across * environment_harmonics[9] + y * z * (3.0 * s.x - s.y) * environment_harmonics[10];
    sum += x * y * (five - 1.0) * environment_harmonics[11] + y * z * (five - 3.0) * environment_harmonics[12];
    sum += ((35.0 * s.z - 30.0) * s.z + 3.0) * environment_harmonics[13];
    sum += x * z * (five - 3.0) * environment_harmonics[14] + across * (five - 1.0) * environment_harmonics[15];
    sum += x * z * (s.x - 3.0 * s.y) * environment_harmonics[16];
    sum += (s.x * (s.x - 3.0 * s.y) - s.y * (3.0 * s.x - s.y)) * environment_harmonics[17];
    return max(sum, vec3(0.0));
}

// What a point sends of it [W m-2 sr-1]: matt in its own colour by openness, and as a mirror by its own shadow.
vec3 environment_returned(Surfel surfel, vec3 to_eye, float diffuse, float specular, float level) {
    vec3 mirrored = 2.0 * dot(to_eye, surfel.normal) * surfel.normal - to_eye;
    vec3 matt = surfel.colour * environment_irradiance(surfel.normal) * (surfel.openness / ENVIRONMENT_PI);
    float free = self_shadow_visibility(surfel, mirrored);
    return diffuse * matt + (specular * free) * environment_radiance(mirrored, level);
}
