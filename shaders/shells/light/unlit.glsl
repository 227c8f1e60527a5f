// Matter shines by itself with its own colour. Dufort 2005, section 5.1.2; Max 1995, emission and absorption.
//
// Symbols: level, radiance of white matter (W m-2 sr-1); voxels that glow send their glow on top of it.

vec3 light_source(Ray ray, float distance, vec3 place, float level, Matter matter, mat3 gradients) {
    float glow = matter_normal(place, level, matter, gradients).w * voxels_glow;
    return matter.colour * (light_level + glow);
}

vec3 light_base(vec3 point, vec3 normal, bool sunlit, vec3 colour) {
    return colour * light_level;
}
