// A frame about a unit normal (Duff et al. 2017, JCGT 6 (1), listing 3) and octahedral normals.
//
// Porquet 2005 turns one angle of the normal instead, which is square only by one reading (errata 003-3).
// renderer/directional/frames.py has the twin.

mat3 frame_of(vec3 normal) {
    float side = normal.z >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (side + normal.z);
    float b = normal.x * normal.y * a;
    return mat3(vec3(1.0 + side * normal.x * normal.x * a, side * b, -side * normal.x),
                vec3(b, side + normal.y * normal.y * a, -normal.y),
                normal);
}

// Unit normal of 16 + 16 bits.
vec3 normal_of(uint code) {
    vec2 plane = vec2(float(code & 0xFFFFu), float(code >> 16)) * (2.0 / 65535.0) - 1.0;
    float z = 1.0 - abs(plane.x) - abs(plane.y);
    vec2 folded = (1.0 - abs(plane.yx)) * vec2(plane.x >= 0.0 ? 1.0 : -1.0, plane.y >= 0.0 ? 1.0 : -1.0);
    return normalize(vec3(z >= 0.0 ? plane : folded, z));
}
