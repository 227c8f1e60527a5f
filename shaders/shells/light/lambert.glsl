// Each voxel reflects by its own normal, as Lambert's paper does. Dufort 2005, section 5.3.1; errata 002-10.
//
// Symbols: N, mean normal in the world, as short as the matter's disagree; without one, light goes off to all sides alike and
// (N . s) becomes a quarter. E = sun_irradiance, sky_irradiance (W m-2); V = sun_visibility. The sky is not shadowed.

const float LIGHT_PI = 3.14159265358979;

vec3 light_source(Ray ray, float distance, vec3 place, float level, Matter matter, mat3 gradients) {
    vec4 normal = matter_normal(place, level, matter, gradients);
    float agreed = length(normal.xyz);
    float facing = max(dot(normal.xyz, sun_direction), 0.0) + 0.25 * (1.0 - agreed);
    float visibility = sun_visibility(ray.origin + distance * ray.direction);
    vec3 arriving = sun_irradiance * (facing * visibility) + sky_irradiance * (0.5 * (1.0 + normal.z));
    return matter.colour * (arriving / LIGHT_PI + normal.w * voxels_glow);
}

// sunlit: whether the face itself, not its smooth normal alone, is turned to the sun.
vec3 light_base(vec3 point, vec3 normal, bool sunlit, vec3 colour) {
    float facing = sunlit ? max(dot(normal, sun_direction), 0.0) : 0.0;
    vec3 arriving = sun_irradiance * (facing * sun_visibility(point)) + sky_irradiance * (0.5 * (1.0 + normal.z));
    return colour * arriving / LIGHT_PI;
}
