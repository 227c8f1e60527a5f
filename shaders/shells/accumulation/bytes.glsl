// Colours in bytes. Dufort 2005, section 5.2.2.
//
// Symbols: sum, light (W m-2 sr-1) and opacity gathered so far, rounded to the nearest of 256 steps after each segment; white, the
// largest of them.

vec4 accumulation_kept(vec4 sum) {
    vec4 white = vec4(vec3(accumulation_white), 1.0);
    return floor(clamp(sum / white, 0.0, 1.0) * 255.0 + 0.5) / 255.0 * white;
}
