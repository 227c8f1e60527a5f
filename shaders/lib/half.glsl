// Rounding to half precision before a target of half floats is written: drivers may cut digits off instead, which makes all a
// little darker. IEEE 754-2008, section 3.6 (eleven significant bits).
vec4 nearest_half(vec4 x) {
    return uintBitsToFloat((floatBitsToUint(x) + 0x1000u) & 0xffffe000u);
}
