// Order by sorting: cells come front to back, sorted on the CPU, and each is laid under what came before it. Cook, Max, Silva
// & Williams 2004, "Image-space visibility ordering"; Dufort 2005, section 4.3; errata 002-3, 002-6.
//
// Symbols: sum, what a cell leaves: premultiplied light and opacity, blended with the weights (1 - alpha_dst, 1).

vec4 order_gathered(vec4 sum) {
    return sum;
}
