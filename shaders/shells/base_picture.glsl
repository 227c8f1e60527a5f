// The picture on the surface under the shell: by longitude and latitude round the world's origin, or by the texture coordinates.
// Dufort 2005, figure 5.7.
//
// Symbols: base_picture, linear reflectance, its rows upwards, and means of it; picture_turn, share of a turn that it is turned by
// eastwards; picture_repeats, pictures a repeat of the texture. The level's texels are half as wide as a pixel that looks straight at
// the surface: what finer ones differ by is left to the samples of a pixel.

const float PICTURE_PI = 3.14159265358979;

vec3 base_reflectance(vec3 point, int tet, float distance) {
#if BASE_PICTURE == 1
    vec3 away = point - picture_centre;
    float radius = max(length(away), 1.0e-20);
    vec2 place = vec2(atan(away.y, away.x) / (2.0 * PICTURE_PI) + 0.5 - picture_turn, 0.5 + asin(clamp(away.z / radius, -1.0, 1.0)) / PICTURE_PI);
    float texels = float(textureSize(base_picture, 0).y) / (PICTURE_PI * radius); // a metre
#elif BASE_PICTURE == 2
    vec4 u = tet_texel(tet, 4), v = tet_texel(tet, 5);
    vec2 place = picture_repeats * vec2(dot(u.xyz, point) + u.w, dot(v.xyz, point) + v.w);
    vec2 sides = picture_repeats * vec2(textureSize(base_picture, 0)) * vec2(length(u.xyz), length(v.xyz));
    float texels = max(sides.x, sides.y);
#endif
#if BASE_PICTURE > 0
    float level = max(log2(max(pixel_width(distance) * texels, 1.0e-6)) - 1.0, 0.0);
    return base_colour * textureLod(base_picture, place, level).rgb;
#else
    return base_colour;
#endif
}
