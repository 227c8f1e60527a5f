// What a ray gathered, laid before the sky where that is the background; else with its opacity.
// light: premultiplied, W m-2 sr-1. direction: unit vector of the ray.

vec4 before_sky(vec3 light, float opacity, vec3 direction) {
#if BACKGROUND_SKY == 1
    return vec4(light + (1.0 - opacity) * (sky_radiance(direction) + sky_sun_disc(direction)), 1.0);
#else
    return vec4(light, opacity);
#endif
}
