// A point of the cloud as the GPU holds it (Porquet 2005: a quantised lit surfel), and its shadow's code.
//
// Symbols: surfels, one texel a point: position 3 x 16 bits in the box, openness 8, octahedral normal 2 x 16, colour
// 3 x 8 as sRGB codes. shadow_code, `SHADOW_BLOCKS` texels a point.
// Places are metres from the middle of the box.
// Deviation: the thesis keeps 15 bytes, of which 3 for a position of 1 byte an axis; here 16 bytes and the code beside.

const uint NO_POINT = 0xFFFFFFFFu;
const int SURFEL_ROW = 2048; // points a row of texels
const int CODE_ROW = min(SURFEL_ROW, 16384 / max(SHADOW_BLOCKS, 1)); // of codes: no wider than every OpenGL has

struct Surfel {
    uint index;
    vec3 position;  // m from the middle of the box
    vec3 normal;    // unit vector
    vec3 tangent;
    vec3 bitangent;
    vec3 colour;    // linear reflectance
    float openness; // share of the sky's light that reaches the point
};

vec3 place_of(uvec4 texel) {
    vec3 share = vec3(float(texel.x & 0xFFFFu), float(texel.x >> 16), float(texel.y & 0xFFFFu)) / 65535.0;
    return mix(box_low, box_high, share);
}

vec3 linear_of(vec3 code) {
    vec3 low = code / 12.92;
    vec3 high = pow((code + 0.055) / 1.055, vec3(2.4));
    return mix(low, high, step(vec3(0.04045), code));
}

uvec4 surfel_texel(uint point) {
    int number = int(point);
    return texelFetch(surfels, ivec2(number % SURFEL_ROW, number / SURFEL_ROW), 0);
}

Surfel surfel_of(uint point) {
    uvec4 texel = surfel_texel(point);
    Surfel surfel;
    surfel.index = point;
    surfel.position = place_of(texel);
    mat3 frame = frame_of(normal_of(texel.z));
    surfel.tangent = frame[0];
    surfel.bitangent = frame[1];
    surfel.normal = frame[2];
    surfel.colour = linear_of(vec3(float(texel.w & 255u), float((texel.w >> 8) & 255u), float((texel.w >> 16) & 255u)) / 255.0);
    surfel.openness = float((texel.y >> 16) & 255u) / 255.0;
    return surfel;
}

// Four words of a point's shadow code.
uvec4 shadow_words(uint point, int block) {
    int number = int(point);
    return texelFetch(shadow_code, ivec2((number % CODE_ROW) * SHADOW_BLOCKS + block, number / CODE_ROW), 0);
}
