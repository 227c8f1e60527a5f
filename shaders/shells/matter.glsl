// What the 3D texture holds at a place. Dufort 2005, section 3.2; errata 002-1, 002-4.
// Symbols: place, texture coordinates (u, v, w); extinction, -ln(1 - alpha) / reference length (1/m); level, of the pyramid.
// `extinction` and `nearest` keep colour x extinction and extinction, as shares of matter_scale (1/m); `straight` keeps
// colour and alpha apart, each interpolated by itself.

const float LEAST_PASSED = 1.0 / 4096.0; // transmittance of a reference length through what is opaque

struct Matter {
    vec3 colour;
    float extinction;
};

float filter_extinction(float own, vec3 place, float level);

// Extinction (1/m) of a number that a texture keeps.
float matter_stored(float number) {
#if INTERPOLATION == STRAIGHT
    return -log(max(1.0 - number, LEAST_PASSED)) * matter_scale;
#else
    return number * matter_scale;
#endif
}

Matter matter_at(vec3 place, float level) {
    vec4 texel = textureLod(shell_matter, place, level);
    float extinction = filter_extinction(matter_stored(texel.a), place, level);
#if INTERPOLATION == STRAIGHT
    return Matter(texel.rgb, extinction);
#else
    return Matter(texel.rgb / max(texel.a, 1.0e-7), extinction);
#endif
}

// Extinction alone, 1/m.
float matter_extinction(vec3 place, float level) {
    return matter_at(place, level).extinction;
}

// Mean normal of the matter in the world, as short as it disagrees, and the share of glow.
vec4 matter_normal(vec3 place, float level, Matter matter, mat3 gradients) {
    vec4 texel = textureLod(shell_normal, place, level);
    texel.xyz = texel.xyz * normal_coding.x + normal_coding.y;
#if INTERPOLATION != STRAIGHT
    // Which it is weighted with, and not what a ray through it would find.
    texel /= max(textureLod(shell_matter, place, level).a, 1.0e-7);
#endif
    float share = min(length(texel.xyz), 1.0);
    vec3 towards = gradients * (texel.xyz * shell_size);
    return vec4(share * towards / max(length(towards), 1.0e-20), texel.w);
}
