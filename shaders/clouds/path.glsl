// A ray against spheres round the planet's centre, in float32 without cancellation.
//
// formulas a8. Symbols (paper <-> code): o + t w: origin, direction (unit), site at the origin, centre at (0, 0, -R);
// R planet_radius (m). With q = o - centre: b = q.w, c = |q|^2 - R^2, and for the sphere at altitude a the roots of
// t^2 + 2 b t + c - a (2R + a) = 0.
// Deviations: differences of squares near 4e13 m2 would leave nothing in float32, so b, c and b^2 - c are summed in pairs of
// floats (Dekker 1971, Knuth 1969) and rounded once; every difference of radii is a product (r1 - r2)(r1 + r2).
// It does not claim more than the 2 m to which float32 knows a radius seen from 20,000 km.

const float NEVER = 1.0e30; // m, farther than anything

struct Path {
    float along;    // b, m: minus the distance along the ray to the point nearest the centre
    float excess;   // c, m2
    float depth;    // R^2 - d^2, m2, d the least distance of the ray's line from the centre
    float altitude; // of the origin, m
};

// A number that a compiler cannot see through: it would take (a + b) - a for b, and the rounding error for nothing.
float rounded(float x) {
    return intBitsToFloat(floatBitsToInt(x) ^ int(planet_radius < 0.0));
}

// Sum and its rounding error (Knuth 1969).
vec2 two_sum(float a, float b) {
    float s = rounded(a + b);
    float v = rounded(s - a);
    return vec2(s, (a - (s - v)) + (b - v));
}

// Product and its rounding error (Dekker 1971), each factor cut into its upper twelve bits and the rest.
vec2 two_product(float a, float b) {
    float p = rounded(a * b);
    vec2 high = intBitsToFloat(floatBitsToInt(vec2(a, b)) & ivec2(0xfffff000));
    vec2 low = vec2(a, b) - high;
    return vec2(p, ((high.x * high.y - p) + high.x * low.y + low.x * high.y) + low.x * low.y);
}

// a . b + c d, as a pair.
vec2 dot_pair(vec3 a, vec3 b, float c, float d) {
    vec2 sum = two_product(c, d);
    for (int k = 0; k < 3; k++) {
        vec2 product = two_product(a[k], b[k]);
        vec2 added = two_sum(sum.x, product.x);
        sum = vec2(added.x, sum.y + added.y + product.y);
    }
    return two_sum(sum.x, sum.y);
}

// |q|^2 - R^2 of an origin, as a pair, m2.
vec2 excess_of(vec3 origin) {
    return dot_pair(origin, origin, 2.0 * planet_radius, origin.z);
}

// origin: m. c: its excess. direction: unit vector, as exactly as float32 holds one.
Path path_from(vec3 origin, vec2 c, vec3 direction) {
    vec2 b = dot_pair(origin, direction, planet_radius, direction.z);
    vec2 longer = dot_pair(direction, direction, 1.0, -1.0); // how much its square is off one
    vec2 bb = two_product(b.x, b.x);
    vec2 d = two_sum(bb.x, -c.x);
    float rest = bb.y + 2.0 * b.x * b.y - c.y - bb.x * (longer.x + longer.y);
    float radius = length(origin + vec3(0.0, 0.0, planet_radius));
    return Path(b.x, c.x, d.x + (d.y + rest), c.x / (radius + planet_radius));
}

Path path_of(vec3 origin, vec3 direction) {
    return path_from(origin, excess_of(origin), direction);
}

// The same where only altitudes along the ray are asked, which half a metre in b moves by millimetres.
Path path_near(vec3 origin, float c, vec3 direction) {
    return Path(dot(origin, direction) + planet_radius * direction.z, c, 0.0, 0.0);
}

float path_altitude(Path path, float t) {
    float square = path.excess + t * (2.0 * path.along + t);
    return square / (sqrt(max(square, -planet_radius * planet_radius) + planet_radius * planet_radius) + planet_radius);
}

// Distances to the sphere at an altitude, near and far; (NEVER, -NEVER) where the line misses it.
vec2 path_distances(Path path, float altitude) {
    float d = path.depth + altitude * (2.0 * planet_radius + altitude);
    float root = sqrt(max(d, 0.0));
    float product = (path.altitude - altitude) * (2.0 * planet_radius + path.altitude + altitude);
    float outer = abs(path.along) + root; // the root that does not cancel
    float inner = product / max(outer, 1.0e-20);
    vec2 found = path.along < 0.0 ? vec2(inner, outer) : vec2(-outer, -inner);
    return d < 0.0 ? vec2(NEVER, -NEVER) : found;
}

// Distance to the sphere itself, ahead of the origin; NEVER where the ray misses it.
float sphere_distance(Path path) {
    float near = path_distances(path, 0.0).x;
    return near > 0.0 ? near : NEVER;
}

// The two stretches of a ray inside the shell between two altitudes: start and length of the one before the point nearest
// the centre, start and length of the one behind it, m; from the origin on and no farther than `end`. A ray that passes
// above the shell's base has two that touch.
vec4 layer_legs(Path path, float base, float top, float end) {
    float over = path.depth + top * (2.0 * planet_radius + top);
    float under = path.depth + base * (2.0 * planet_radius + base);
    float outer = sqrt(max(over, 0.0)), inner = sqrt(max(under, 0.0));
    float side = under > 0.0 ? (top - base) * (2.0 * planet_radius + top + base) / (outer + inner) : outer;
    float to_top = (path.altitude - top) * (2.0 * planet_radius + path.altitude + top);
    float to_base = (path.altitude - base) * (2.0 * planet_radius + path.altitude + base);
    float b = path.along;
    bool down = b < 0.0, above = path.altitude > top, below = path.altitude < base;
    float to_middle = under > 0.0 ? to_base / max(inner - b, 1.0e-20) : -b; // going down inside the layer
    vec4 legs;
    legs.xy = !down || below ? vec2(0.0) : above ? vec2(to_top / max(outer - b, 1.0e-20), side) : vec2(0.0, to_middle);
    legs.zw = down ? vec2(inner - b, side)
            : below ? vec2(-to_base / max(b + inner, 1.0e-20), side)
            : above ? vec2(0.0) : vec2(0.0, -to_top / max(b + outer, 1.0e-20));
    legs.yw = over > 0.0 ? clamp(vec2(end) - legs.xz, vec2(0.0), legs.yw) : vec2(0.0);
    return legs;
}

// Unit vector away from the centre.
vec3 up_at(vec3 point) {
    return normalize(point + vec3(0.0, 0.0, planet_radius));
}

// Metres east and north of the site in the stereographic projection: where a point stands on every map. Conformal, and 1 % off
// the distance along the ground at 2,200 km.
vec2 place_of(vec3 point) {
    float up = point.z + planet_radius;
    return point.xy * (2.0 * planet_radius / max(sqrt(dot(point.xy, point.xy) + up * up) + up, 1.0));
}
