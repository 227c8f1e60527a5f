// The shell's tetrahedra and a ray's way through one of them. Dufort 2005, sections 3.1, 3.3 and 5.1.1.
// Symbols: tet, number of a tetrahedron; its eight texels in shell_tets: the planes (outward unit normal, distance from the
// origin, m) opposite its four vertices, the three rows of the affine map from the world to texture space, and the four
// neighbours across those planes, negative at the shell's boundary. t, distance along a ray (m).
// Places are metres from the middle of the shell, so that float32 keeps its precision wherever it stands.

const int TET_ROW = 512;      // tetrahedra a row of texels
const int BEYOND_TOP = -1;    // instead of a neighbour: the shell's top, its base, the side of an open edge
const int BEYOND_BASE = -2;
const int BEYOND_RIM = -3;

vec3 way_shares = vec3(0.0); // squares of a ray's direction by the texture's axes, of the segment that was found last;
vec3 way_from = vec3(0.0);    // texture coordinates of a place of it,
vec3 way_point = vec3(0.0);   // the place, m,
mat3 way_gradients = mat3(0.0); // and its gradients, 1/m
int tet_here = -1;            // that holds what is lit, where the order of drawing tells it

struct Ray {
    vec3 origin;
    vec3 direction; // unit vector
};

// A ray's way through one tetrahedron: texture coordinates and distances where it enters and leaves, m, and the gradients
// of u, v and w in the world, 1/m.
struct Segment {
    vec3 from;
    vec3 to;
    float near;
    float far;
    mat3 gradients;
};

struct Exit {
    float t;
    int face; // the vertex opposite to it
};

vec4 tet_texel(int tet, int item) {
    return texelFetch(shell_tets, ivec2((tet % TET_ROW) * 8 + item, tet / TET_ROW), 0);
}

// Distance at which a ray meets a plane.
float plane_distance(Ray ray, vec4 plane) {
    return -(dot(plane.xyz, ray.origin) + plane.w) / dot(plane.xyz, ray.direction);
}

void leave_by(Ray ray, vec4 plane, int face, inout Exit exit) {
    float t = plane_distance(ray, plane);
    bool nearer = dot(plane.xyz, ray.direction) > 0.0 && t < exit.t;
    exit.t = nearer ? t : exit.t;
    exit.face = nearer ? face : exit.face;
}

// Where a ray that has come into a tetrahedron at `enter` leaves it: at the nearest of the planes that it runs out through.
Exit tet_exit(Ray ray, int tet, float enter) {
    Exit exit = Exit(1.0e30, -1);
    leave_by(ray, tet_texel(tet, 0), 0, exit);
    leave_by(ray, tet_texel(tet, 1), 1, exit);
    leave_by(ray, tet_texel(tet, 2), 2, exit);
    leave_by(ray, tet_texel(tet, 3), 3, exit);
    // Rounding may put a plane that is met at an edge a little before the entry.
    return Exit(exit.face < 0 ? enter : max(exit.t, enter), exit.face);
}

// The way between two distances, by the three rows of a map to texture space.
Segment way_segment(Ray ray, float near, float far, vec4 u, vec4 v, vec4 w) {
    vec3 start = vec3(dot(u.xyz, ray.origin) + u.w, dot(v.xyz, ray.origin) + v.w, dot(w.xyz, ray.origin) + w.w);
    start.xy += texture_slide;
    vec3 slope = vec3(dot(u.xyz, ray.direction), dot(v.xyz, ray.direction), dot(w.xyz, ray.direction));
    vec3 shares = slope * slope / max(vec3(dot(u.xyz, u.xyz), dot(v.xyz, v.xyz), dot(w.xyz, w.xyz)), 1.0e-20);
    way_shares = shares / max(shares.x + shares.y + shares.z, 1.0e-20);
    way_gradients = mat3(u.xyz, v.xyz, w.xyz);
    way_from = start + near * slope;
    way_point = ray.origin + near * ray.direction;
    return Segment(way_from, start + far * slope, near, far, way_gradients);
}

Segment tet_segment(Ray ray, int tet, float near, float far) {
    return way_segment(ray, near, far, tet_texel(tet, 4), tet_texel(tet, 5), tet_texel(tet, 6));
}

// The tetrahedron beyond a face, or why there is none.
int tet_beyond(int tet, int face) {
    return int(tet_texel(tet, 7)[max(face, 0)]);
}
