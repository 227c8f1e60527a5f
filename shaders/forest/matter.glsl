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

const float INVERSE_PI = 0.3183098861837907;

// By how much the sides of the leaves that are seen face the zenith, -1 to 1. A leaf m shows |m.v|: the flat share kappa counts with
// kappa |n.v|, the others, facing everywhere, with (1 - kappa) / 2, and the mean of (m.v) m over them is v / 3.
float facing_up(Matter matter, vec3 to_eye) {
    float across = dot(matter.normal, to_eye);
    float up = mix(to_eye.z / 3.0, across * matter.normal.z, matter.flatness);
    return up / max(mix(0.5, abs(across), matter.flatness), 1e-4);
}

// What even light from the upper half of the sky leaves as, per unit of its irradiance and times pi: the side of a leaf that faces up by
// n_z gets the share (1 + n_z) / 2 of it, the other side the rest.
vec3 sky_answer(Matter matter, vec3 to_eye) {
    return 0.5 * (matter.albedo + matter.passed + facing_up(matter, to_eye) * (matter.albedo - matter.passed));
}
