// Light that comes from a direction of the surroundings: the sky, or a picture of all directions.
//
// Blinn & Newell 1976. Twin: `image_of` in renderer/directional/environments.py.
// Symbols: light_environment, equirectangular radiance, row 0 at the zenith, u = azimuth clockwise / 2 pi; its level k is
// convolved with a cosine lobe of a quarter of the exponent of level k - 1. Radiance W m-2 sr-1.

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
