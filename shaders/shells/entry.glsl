// Where a pixel's ray comes into the shell for the layer-th time: distance (m) and tetrahedron, negative where it does not, and a
// half more where it meets the back of an opaque surface there.

vec2 entry_of(ivec2 pixel, int layer) {
    ivec2 at = pixel + ivec2(0, (layer / 2) * entry_height);
    return layer % 2 == 0 ? texelFetch(entry_even, at, 0).xy : texelFetch(entry_odd, at, 0).xy;
}

bool entry_behind(vec2 entry) {
    return fract(entry.y) > 0.25;
}
