// Colours in single precision. IEEE 754-1985.
//
// Symbols: sum, light and opacity gathered so far, which are kept as they are.

vec4 accumulation_kept(vec4 sum) {
    return sum;
}
