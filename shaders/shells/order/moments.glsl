// Transmittance in front of a depth from four power moments of absorbance. Münstermann, Krumpen, Klein & Peters 2018,
// "Moment-based order-independent transparency", sections 3.1 to 3.4, algorithm 1 for four moments; formulas e.
//
// Symbols: b_0, absorbance of the whole pixel, sum of -ln(1 - alpha); b, sums of absorbance z^j over b_0, j = 1..4; z, depth
// in [-1, 1]; the estimate lies between the least and the greatest step function that has these moments. Several sharp opaque
// layers leak through each other.

const vec4 ORDER_EVEN = vec4(0.0, 0.375, 0.0, 0.375); // moments that the bias leads to

float order_transmittance(float b_0, vec4 sums, float depth) {
    vec4 b = mix(sums / max(b_0, 1.0e-12), ORDER_EVEN, order_bias);
    // Cholesky factors of the Hankel matrix of 1, b.
    float d11 = max(b.y - b.x * b.x, 1.0e-12);
    float l21d11 = b.z - b.x * b.y;
    float l21 = l21d11 / d11;
    float d22 = max(b.w - b.y * b.y - l21d11 * l21, 1.0e-12);
    vec3 c = vec3(1.0, depth - b.x, depth * depth - b.y);
    c.z -= l21 * c.y;
    c.y /= d11;
    c.z /= d22;
    c.y -= l21 * c.z;
    c.x -= c.y * b.x + c.z * b.y;
    // The other two depths of the three at which all of the absorbance may lie.
    float scale = abs(c.z) > 1.0e-20 ? 1.0 / c.z : 1.0e20;
    float p = c.y * scale, q = c.x * scale;
    float root = sqrt(max(0.25 * p * p - q, 0.0));
    vec3 z = vec3(depth, -0.5 * p - root, -0.5 * p + root);
    // Newton's interpolation of the step function at the three.
    vec3 f = vec3(order_overestimation, float(z.y < z.x), float(z.z < z.x));
    float f01 = (f.y - f.x) / (z.y - z.x), f12 = (f.z - f.y) / (z.z - z.y), f012 = (f12 - f01) / (z.z - z.x);
    float linear = f01 - f012 * z.y;
    vec3 polynomial = vec3(f.x - linear * z.x, linear - f012 * z.x, f012);
    float share = polynomial.x + dot(b.xy, polynomial.yz);
    return clamp(exp(-b_0 * share), 0.0, 1.0);
}
