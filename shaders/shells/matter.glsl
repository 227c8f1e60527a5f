// What the 3D texture holds at a place. Dufort 2005, section 3.2; errata 002-1, 002-4.
// Symbols: place, texture coordinates (u, v, w); extinction, -ln(1 - alpha) / reference length (1/m); level, of the pyramid.
// `extinction` and `nearest` keep colour x extinction and extinction, as shares of matter_scale (1/m); `straight` keeps
// colour and alpha apart, each interpolated by itself.

const float LEAST_PASSED = 1.0 / 4096.0; // transmittance of a reference length through what is opaque

struct Matter {
    vec3 colour;
    float extinction;
};

Matter matter_at(vec3 place, float level) {
    vec4 texel = textureLod(shell_matter, place, level);
#if INTERPOLATION == STRAIGHT
    return Matter(texel.rgb, -log(max(1.0 - texel.a, LEAST_PASSED)) * matter_scale);
#else
    return Matter(texel.rgb / max(texel.a, 1.0e-7), texel.a * matter_scale);
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
    texel *= matter_scale / max(matter.extinction, max(1.0e-7 * matter_scale, 1.0e-20));
#endif
    float share = min(length(texel.xyz), 1.0);
    vec3 towards = gradients * (texel.xyz * shell_size);
    return vec4(share * towards / max(length(towards), 1.0e-20), texel.w);
}
