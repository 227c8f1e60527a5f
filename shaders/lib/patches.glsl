// Patches of ground: value noise of two octaves, smooth and without a period. Perlin 1985 (lattice noise); Ebert et al. 2003,
// "Texturing and Modeling", chapter 2 (value noise, smoothstep between the nodes).
// Symbols: xy position [m]; the result is in [-1, 1]. Node values come from the tiling's hash (formulas b1), kinds 5 and 6: kinds
// 0 to 4 lay the tiles. The second octave is turned by the angle of the triangle 3-4-5, so that no direction stands out.
// Twin: `patches` in renderer/reference/forest_lookup.py. It does not claim to be any meadow's statistics.

#include "lib/hash.glsl"

const float PATCH_COARSE = 25.0; // m between nodes
const float PATCH_FINE = 10.0;
const float PATCH_SHARE = 0.65;  // of the coarse octave

float patch_octave(vec2 place, uint kind) {
    vec2 corner = floor(place);
    vec2 f = place - corner;
    vec2 w = f * f * (3.0 - 2.0 * f);
    uvec2 low = uvec2(ivec2(corner));
    uvec2 east = uvec2(low.x, low.x + 1u) * 0x8da6b343u;
    uvec2 north = uvec2(low.y, low.y + 1u) * 0xd8163841u ^ kind * 0xcb1ab31fu;
    vec2 south_row = vec2(hash_unit(lowbias32(east.x ^ north.x)), hash_unit(lowbias32(east.y ^ north.x)));
    vec2 north_row = vec2(hash_unit(lowbias32(east.x ^ north.y)), hash_unit(lowbias32(east.y ^ north.y)));
    vec2 rows = mix(south_row, north_row, w.y);
    return 2.0 * mix(rows.x, rows.y, w.x) - 1.0;
}

float patches_at(vec2 xy) {
    vec2 turned = vec2(0.8 * xy.x - 0.6 * xy.y, 0.6 * xy.x + 0.8 * xy.y);
    return mix(patch_octave(turned / PATCH_FINE, 6u), patch_octave(xy / PATCH_COARSE, 5u), PATCH_SHARE);
}
