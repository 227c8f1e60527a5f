// No order: cells as they are stored. With the depth buffer, matter from ORDER_CUT on is opaque and the rest is nothing.

vec4 order_gathered(vec4 sum) {
#if ORDER_DEPTH == 1
    if (sum.a < order_cut) discard;
    return vec4(sum.rgb / sum.a, 1.0);
#else
    return sum;
#endif
}
