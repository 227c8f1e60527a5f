// The opaque surface under the shell: where a ray meets it, and its light.
// Symbols: shell_base, of each prism's three vertices on the surface, its normal over the distance from the plane opposite to it
// (1/m): with the distances of a place from these planes, that is the normal between the vertices.

const int BASE_ROW = 512; // prisms a row of texels

vec3 base_reflectance(vec3 point, int tet, float distance);

// Smooth normal of a place on the surface, under the first tetrahedron of a prism.
vec3 base_normal(int tet, vec3 point) {
    int prism = tet / 3;
    vec3 sum = vec3(0.0);
    for (int k = 0; k < 3; k++) {
        vec4 plane = tet_texel(tet, k);
        vec3 normal = texelFetch(shell_base, ivec2((prism % BASE_ROW) * 3 + k, prism / BASE_ROW), 0).xyz;
        sum += (dot(plane.xyz, point) + plane.w) * normal;
    }
    return normalize(sum);
}

const int BASE_FACE = 3; // of the first tetrahedron of a prism

// tet, face: through which the ray came to it at `t`; the face's own normal points out of the shell. Both sides reflect alike.
vec3 base_radiance(Ray ray, int tet, int face, float t) {
    vec3 point = ray.origin + t * ray.direction, outward = tet_texel(tet, max(face, 0)).xyz;
    tet_here = tet;
    tet_segment(ray, tet, t, t);
    float side = dot(outward, ray.direction) > 0.0 ? 1.0 : -1.0;
    return light_base(point, side * base_normal(tet, point), side * dot(outward, sun_direction) < 0.0, base_reflectance(point, tet, t));
}

#ifdef TRACED
vec2 base_hit = vec2(-1.0); // where a ray met the surface, m, and 4 tetrahedron + face

void base_met(Ray ray, int tet, int face, float t, inout vec4 sum) {
    base_hit = vec2(t, float(4 * tet + max(face, 0)));
}
#else
void base_met(Ray ray, int tet, int face, float t, inout vec4 sum) {
    sum += (1.0 - sum.a) * vec4(base_radiance(ray, tet, face, t), 1.0);
}
#endif
