// Colours in half precision. Dufort 2005, section 5.2.2; IEEE 754-1985, binary16: 11 digits, the smallest step 2^-24.
//
// Symbols: sum, light (W m-2 sr-1) and opacity gathered so far, rounded to the nearest after each segment.

vec4 accumulation_kept(vec4 sum) {
    vec4 stride = exp2(floor(log2(max(abs(sum), exp2(-14.0)))) - 10.0);
    return floor(sum / stride + 0.5) * stride;
}
