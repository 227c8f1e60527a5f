// The opaque surface under the shell: where a ray meets it, and its light.

// tet, face: through which the ray came to it at `t`. Its normal is that of the tetrahedron's face, which points out of the shell.
vec3 base_radiance(Ray ray, int tet, int face, float t) {
    vec3 normal = -tet_texel(tet, max(face, 0)).xyz;
    return light_base(ray.origin + t * ray.direction, normal, base_colour);
}
