// Light from all directions: what a mirror sees of it, and what it sends to a plane.
//
// Porquet 2005, section 3.3.2 (environment mapping); Ramamoorthi & Hanrahan 2001, equations 8 and 13: irradiance from
// spherical harmonics, here of bands 0, 1, 2 and 4 (band 3 is nothing). Twins: renderer/directional/environment_light.py.
// Symbols: light_environment, equirectangular radiance, row 0 at the zenith, u = azimuth clockwise / 2 pi; its level k is
// convolved with a cosine lobe of a quarter of the exponent of level k - 1. Radiance W m-2 sr-1, irradiance W m-2.

const float ENVIRONMENT_PI = 3.14159265358979;

// A direction in the picture's own frame, which is turned clockwise about the zenith.
vec3 environment_own(vec3 direction) {
    vec2 turn = environment_said.xy;
    return vec3(direction.x * turn.x - direction.y * turn.y, direction.y * turn.x + direction.x * turn.y, direction.z);
}

vec3 environment_radiance(vec3 direction, float level) {
#if ENVIRONMENT_SKY
    return environment_said.z * sky_radiance(direction);
#else
    vec3 own = environment_own(direction);
    float azimuth = dot(own.xy, own.xy) > 0.0 ? atan(own.x, own.y) : 0.0;
    vec2 place = vec2(azimuth / (2.0 * ENVIRONMENT_PI), atan(length(own.xy), own.z) / ENVIRONMENT_PI);
    return environment_said.z * textureLod(light_environment, place, min(level, environment_said.w)).rgb;
#endif
}

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
