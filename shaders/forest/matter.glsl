// What a ray met in the canopy, as the light slot sees it: leaves or wood of a voxel. Ross 1981 (leaves as thin sheets).
// Symbols: albedo reflectance and passed transmittance of the leaves [-]; normal unit mean normal; flatness length kappa of the mean
// normal, 1 where all leaves lie alike, 0 where they face everywhere; slope unit normal of the ground; place atlas u, v and h; level.

struct Matter {
    vec3 albedo;
    vec3 passed;
    vec3 normal;
    float flatness;
    vec3 slope;
    vec3 place;
    float level;
};

// Where the sky's light is asked: position [m], atlas u, v and h, level; how far the ground is wooded there (1 in the canopy), and the
// pattern's own share of the sky.
struct Spot {
    vec3 position;
    vec3 place;
    float level;
    float wooded;
    float ambient;
};

// Light of the part of the sky that is seen there, for both sides of a leaf with unit normal n [W/m2]: together they get
// around + upright (n_z^2 - 1/3), and the side of n gets towards n more than the other.
struct Skylight {
    vec3 around;
    vec3 upright;
    mat3 towards;
};

const float INVERSE_PI = 0.3183098861837907;

// An even sky of this irradiance: the side that faces up by n_z gets the share (1 + n_z) / 2 of it, the other side the rest.
Skylight even_sky(vec3 irradiance) {
    return Skylight(irradiance, vec3(0.0), mat3(vec3(0.0), vec3(0.0), irradiance));
}

// What the leaves make of it, times pi. A leaf m shows |m.v|: the flat share kappa counts with kappa |n.v|, the others, facing
// everywhere, with (1 - kappa) / 2, and the mean of (m.v) m over them is v / 3.
vec3 sky_answer(Matter matter, vec3 to_eye, Skylight light) {
    float across = dot(matter.normal, to_eye);
    float shown = max(mix(0.5, abs(across), matter.flatness), 1e-4);
    float flat_share = matter.flatness * abs(across) / shown;
    vec3 seen_side = mix(to_eye / 3.0, across * matter.normal, matter.flatness) / shown;
    vec3 both = light.around + light.upright * (flat_share * (matter.normal.z * matter.normal.z - 1.0 / 3.0));
    vec3 more = light.towards * seen_side;
    return max(0.5 * ((matter.albedo + matter.passed) * both + (matter.albedo - matter.passed) * more), 0.0);
}

// What ground of this albedo and unit normal makes of it, times pi.
vec3 sky_on_ground(vec3 albedo, vec3 normal, Skylight light) {
    return max(0.5 * albedo * (light.around + light.upright * (normal.z * normal.z - 1.0 / 3.0) + light.towards * normal), 0.0);
}
