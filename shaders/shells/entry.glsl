// Where a pixel's ray comes into the shell for the layer-th time: distance (m) and tetrahedron, negative where it does not, and a
// half more where it meets the back of an opaque surface there. Kept is the number of the face, 4 tetrahedron + face.

vec2 entry_of(Ray ray, ivec2 pixel, int layer) {
    ivec2 at = pixel + ivec2(0, (max(layer - 1, 0) / 2) * entry_height);
    float number = layer == 0 ? texelFetch(entry_first, pixel, 0).y
                 : layer % 2 == 0 ? texelFetch(entry_even, at, 0).y : texelFetch(entry_odd, at, 0).y;
    int owner = int(max(number, 0.0) + 0.5), tet = owner / 4;
    float t = plane_distance(ray, tet_texel(tet, owner % 4)), behind = 0.0;
#if BASE_OPAQUE == 1
    behind = int(tet_texel(tet, 7)[owner % 4]) == BEYOND_BASE ? 0.5 : 0.0;
#endif
    return number < 0.0 ? vec2(-1.0) : vec2(t, float(tet) + behind);
}

bool entry_behind(vec2 entry) {
    return fract(entry.y) > 0.25;
}
