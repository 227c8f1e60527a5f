// From linear radiance to the eight bits that a screen is given.
//
// Narkowicz 2015, "ACES Filmic Tone Mapping Curve": f(x) = x(2.51x + 0.03) / (x(2.43x + 0.59) + 0.14).
// IEC 61966-2-1 (sRGB): 12.92 u below 0.0031308, 1.055 u^(1/2.4) - 0.055 above.
// Bayer 1973, "An Optimum Method for Two-Level Rendition of Continuous-Tone Pictures": ordered thresholds.
// Its twin in float64: renderer/world/image.py, `display`.
//
// Does not claim: the curve is a fit to the luminance of the ACES reference transform, applied to each channel; strong
// colours shift in hue with exposure, and the curve reaches 1 at x = 7.2 and is cut there.

#define DISPLAY_LINEAR 0
#define DISPLAY_FILMIC 1

// Light above this is white under both curves; the squares below would overflow far above it.
#define DISPLAY_BRIGHTEST 1.0e4

// Narkowicz 2015. Radiance after exposure, relative to what the linear curve shows as white -> display light in [0, 1].
vec3 display_filmic(vec3 x) {
    return clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
}

// The chosen curve; negative light is black.
vec3 display_curve(vec3 light, int curve) {
    vec3 x = clamp(light, 0.0, DISPLAY_BRIGHTEST);
    return curve == DISPLAY_FILMIC ? display_filmic(x) : min(x, 1.0);
}

// IEC 61966-2-1. Linear display light -> sRGB code in [0, 1].
vec3 display_srgb(vec3 light) {
    vec3 u = clamp(light, 0.0, 1.0);
    return mix(12.92 * u, 1.055 * pow(max(u, 0.0031308), vec3(1.0 / 2.4)) - 0.055, greaterThan(u, vec3(0.0031308)));
}

// Bayer 1973, by the bits of a pixel's place: what is added to an sRGB code before it is rounded to eight bits, in codes.
// Sixteen evenly spread values of mean zero, each once in every square of four pixels: a sky that changes by a few codes
// across the picture shows no bands, and a code that eight bits hold stays what it is.
float display_dither(ivec2 pixel) {
    ivec2 a = ivec2(pixel.x ^ pixel.y, pixel.y);
    ivec2 bits = 8 * (a & 1) / ivec2(1, 2) + (a & 2) / ivec2(1, 2);
    return (float(bits.x + bits.y) + 0.5) / 16.0 - 0.5;
}
