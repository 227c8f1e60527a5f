// The faces of the box, and which point each texel of a face sees from a direction. Porquet 2005.
//
// Symbols: face, 0 to 5: -x, +x, -y, +y, -z, +z; its axes u and v run along y z, x z or x y. TEXELS, d: a face has d x d
// texels. seen, layers of point numbers; seen_depth, of how
// deep they lie, 65534 the box's depth; seen_layer, the layer of each face and direction, or -1;
// seen_round, those of the four directions of a cell of a face's hemisphere.
// Directions point from the surface to the eye, in the face's axes (u, v, outward normal).

struct Entry {
    int face; // or -1
    vec3 place; // m from the middle of the box
};

float face_side(int face) {
    return face % 2 == 1 ? 1.0 : -1.0;
}

vec3 to_face(int face, vec3 direction) {
    vec3 turned = face < 2 ? direction.yzx : face < 4 ? direction.xzy : direction;
    return vec3(turned.xy, turned.z * face_side(face));
}

// Place of a face in the world, from its coordinates in [0, 1].
vec3 face_place(int face, vec2 at) {
    vec3 low = face < 2 ? box_low.yzx : face < 4 ? box_low.xzy : box_low;
    vec3 high = face < 2 ? box_high.yzx : face < 4 ? box_high.xzy : box_high;
    vec3 place = vec3(mix(low.xy, high.xy, at), face % 2 == 1 ? high.z : low.z);
    return face < 2 ? place.zxy : face < 4 ? place.xzy : place;
}

// Coordinates in [0, 1] of a place on a face.
vec2 face_coordinates(int face, vec3 place) {
    vec3 at = (place - box_low) / (box_high - box_low);
    return face < 2 ? at.yz : face < 4 ? at.xz : at.xy;
}

ivec2 face_texel(vec2 at) {
    return clamp(ivec2(floor(at * float(TEXELS))), ivec2(0), ivec2(TEXELS - 1));
}

// Where a line along `towards`, a unit vector that leaves the box, meets the plane of a face.
vec3 onto_face(int face, vec3 place, vec3 towards) {
    int axis = face / 2;
    float plane = face % 2 == 1 ? box_high[axis] : box_low[axis];
    return place + (plane - place[axis]) / towards[axis] * towards;
}

// The point that a texel sees from a direction, by its number.
uint seen_point(int face, int direction, ivec2 texel) {
    int layer = texelFetch(seen_layer, ivec2(direction, face), 0).x;
    return layer < 0 ? NO_POINT : texelFetch(seen, ivec3(texel, layer), 0).x;
}

// How deep below the face a texel's point lies [m], or less than 0 where there is none.
float seen_depth_of(int face, int layer, ivec2 texel) {
    uint depth = texelFetch(seen_depth, ivec3(texel, max(layer, 0)), 0).x;
    return depth == 0xFFFFu ? -1.0 : float(depth) / 65534.0 * (box_high - box_low)[face / 2];
}

// Where a ray comes into the box from outside; not from within.
Entry box_entry(vec3 origin, vec3 direction) {
    vec3 inverse = 1.0 / direction;
    vec3 low = (box_low - origin) * inverse;
    vec3 high = (box_high - origin) * inverse;
    vec3 nearer = min(low, high);
    vec3 farther = max(low, high);
    float near = max(nearer.x, max(nearer.y, nearer.z));
    float far = min(farther.x, min(farther.y, farther.z));
    int axis = nearer.x == near ? 0 : nearer.y == near ? 1 : 2;
    bool met = near > 0.0 && far > near;
    return Entry(met ? 2 * axis + (direction[axis] < 0.0 ? 1 : 0) : -1, origin + near * direction);
}
