// The forest's world: ground, tiles, trees. Neyret & Cani 1999; Decaudin & Neyret 2004; formulas b1.
// Symbols: xy horizontal position [m], x east, y north; g ground height [m]; h normalised canopy height; a tile_side [m];
// uv atlas coordinates on the torus of 4 x 4 rhombi; level mip level, 0 the finest.
// The renderer declares the samplers: heights, normals, cover, tiles, pattern_voxels, pattern_normal.

// Texture coordinate of the terrain grid: node (row 0, column 0) is north-west, texture row 0 is the south.
vec2 terrain_coordinate(vec2 xy) {
    return xy / (terrain_cell * terrain_nodes) + 0.5;
}

// Bilinear ground: height [m] and slopes to the east and the north. One texel holds its cell's four coefficients (value at the
// south-west node, east, north, and both) as shares of terrain_range.x and, either way from one half, of terrain_range.y.
vec3 ground_at(vec2 xy) {
    vec2 place = xy / terrain_cell + 0.5 * (terrain_nodes - 1.0);
    vec2 held = clamp(place, 0.0, terrain_nodes - 1.001);
    vec2 corner = floor(held);
    vec2 f = held - corner;
    vec4 cell = textureLod(heights, (corner + 0.5) / terrain_nodes, 0.0);
    vec3 rise = (cell.yzw - 32768.0 / 65535.0) * 2.0 * terrain_range.y;
    vec2 slope = (rise.xy + f.yx * rise.z) / terrain_cell;
    return vec3(cell.x * terrain_range.x + dot(f, rise.xy) + f.x * f.y * rise.z, held == place ? slope : vec2(0.0));
}

float ground_height(vec2 xy) {
    return ground_at(xy).x;
}

vec3 ground_normal(vec2 xy) {
    return normalize(textureLod(normals, terrain_coordinate(xy), 0.0).xyz);
}

// Whether the ground is wooded, 0 to 1 across the forest's own edge: bilinear cover above one half, where `cover` is a coarse yes or no.
float wooded_at(vec2 xy) {
    return smoothstep(0.45, 0.55, textureLod(normals, terrain_coordinate(xy), 0.0).a);
}

// Share of the trees that stand at a place, and how far off the next one may be [m].
vec2 cover_at(vec2 xy) {
    return textureLod(cover, terrain_coordinate(xy), 0.0).rg * vec2(1.0, 255.0);
}

// Height of the canopy's layer [m]: the pattern's own, stretched where the stand is taller or shorter than it.
float layer_height(vec2 xy) {
#if LOCAL_CANOPY == 1
    return canopy_height * textureLod(growth, terrain_coordinate(xy), 0.0).r;
#else
    return canopy_height;
#endif
}

// Formulas b1: a triangle's tile follows from the hashed colours of its three edges. `tiles` holds the outcome for the cells in reach,
// (4 p + q) of the upward and the downward triangle, because one fetch costs less than the four hashes.
// Lattice: xy = u e1 + v e2, e1 = (a, 0), e2 = (a/2, a sqrt(3)/2).
vec2 atlas_coordinate(vec2 xy) {
    float v = xy.y * (1.1547005383792515 / tile_side);
    vec2 lattice = vec2(xy.x / tile_side - 0.5 * v, v);
    vec2 corner = floor(lattice);
    vec2 f = lattice - corner;
    vec2 both = textureLod(tiles, (corner + 0.5) / TILE_MAP, 0.0).rg;
    float tile = floor((f.x + f.y < 1.0 ? both.x : both.y) * 255.0 + 0.5);
    float p = floor(tile * 0.25);
    return (vec2(p, tile - 4.0 * p) + f) * 0.25;
}

// One voxel of a level, nearest to a place (u, v, h): red green, blue opacity, foot x y, distance wood, two bytes a channel.
// Coarser levels halve its sides, not its height; opacity stays that of one voxel's length of the finest.
vec4 voxel_at(vec3 place, float level) {
    return textureLod(pattern_voxels, vec3(place.xy, place.z * canopy_height / voxel_size - 0.5), level) * 65535.0;
}

// Offset in atlas coordinates, for level 0, that makes the mean of nearest voxels trilinear interpolation: a box one voxel wide.
vec3 voxel_offset(vec4 jitter) {
    vec3 random = fract(vec3(jitter.w, jitter.w * 5.0 + jitter.z, jitter.w * 11.0 + jitter.y));
    return (random - 0.5) * vec3(voxel_size / (4.0 * tile_side), voxel_size / (4.0 * tile_side), voxel_size / canopy_height);
}

vec2 two_bytes(float pair) {
    float high = floor((pair + 0.5) / 256.0);
    return vec2(high, floor(pair - 256.0 * high + 0.5));
}

float opacity_of(vec4 voxel) {
    return min(two_bytes(voxel.y).y / 255.0, 0.99975586);
}

vec3 albedo_of(vec4 voxel) {
    return vec3(two_bytes(voxel.x), two_bytes(voxel.y).x) / 255.0;
}

// Voxels of the finest level that are free all around.
float free_voxels(vec4 voxel) {
    return two_bytes(voxel.w).x;
}

// Whether the voxel is trunk or branch, not leaves.
bool wood_in(vec4 voxel) {
    return two_bytes(voxel.w).y > 127.5;
}

// Foot of the tree that owns the voxel: offset in sixteenths of a metre.
vec2 foot_of(vec2 xy, vec4 voxel) {
    return xy + (two_bytes(voxel.z) - 128.0) * 0.0625;
}

// Whether the tree that owns the voxel stands, 0 or 1, and how far off the next one may be [m]: its rank, of 128 in which the stand is
// thinned, against the share that stands at its foot.
vec2 stand_of(vec2 xy, vec4 voxel) {
    vec2 found = cover_at(foot_of(xy, voxel));
    float rank = mod(two_bytes(voxel.w).y, 128.0) / 128.0;
    return vec2(found.x > rank ? 1.0 : 0.0, found.y);
}

// Slow variation of the trees' colour, from the foot of each tree.
float tint_of(vec2 foot) {
    return sin(foot.x * 0.37 + 1.3 * sin(foot.y * 0.11)) * sin(foot.y * 0.41 + 1.7 * sin(foot.x * 0.13));
}
