// Phong's lobe, normalised. Lafortune & Willems 1994, equations 4 and 5.
//
// Symbols: diffuse, specular: shares of the light that is returned (1); shininess s; r, mirror image of the light's
// direction about the normal. Returned: reflectance [sr-1]. With diffuse + specular at most 1 no energy is made: the
// lobe returns all of its share where the light stands at the zenith, and less where the horizon cuts it.

const float PHONG_PI = 3.14159265358979;

vec3 phong_reflectance(vec3 normal, vec3 colour, vec3 light, vec3 view, float diffuse, float specular, float shininess) {
    vec3 mirrored = 2.0 * dot(normal, light) * normal - light;
    float lobe = pow(max(dot(mirrored, view), 0.0), shininess) * (shininess + 2.0) / (2.0 * PHONG_PI);
    return diffuse / PHONG_PI * colour + specular * lobe;
}
