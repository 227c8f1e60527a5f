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

// Under a species map, SPECIES_MAP canopies are kept of what is baked of one, as if nothing else were planted: of all species mixed,
// and of each alone (species_alone.py). Which of them stands at a place.
float section_at(vec2 xy) {
#if SPECIES_MAP > 0
    return floor(textureLod(species, terrain_coordinate(xy), 0.0).g * 255.0 + 0.5);
#else
    return 0.0;
#endif
}

// Place (u, v, h) in a filtered texture of layers, of the canopy that stands at xy: one is above the other, and none reads the next.
vec3 layered(vec3 place, vec2 xy, float layers) {
#if SPECIES_MAP > 0
    float half_layer = 0.5 * float(SPECIES_MAP) / layers;
    place.z = (section_at(xy) + clamp(place.z, half_layer, 1.0 - half_layer)) / float(SPECIES_MAP);
#endif
    return place;
}

// Place (u, v) in a map of the canopy that stands at xy: they are stacked, each with its last row again before it and its first after.
vec2 stacked(vec2 uv, vec2 xy, vec2 size) {
#if SPECIES_MAP > 0
    float rows = size.y / float(SPECIES_MAP);
    uv.y = (section_at(xy) * rows + 1.0 + fract(uv.y) * (rows - 2.0)) / size.y;
#endif
    return uv;
}

// Share of the trees that makes a closed canopy: less than all where a map leaves them mixed (planting.py, mixed_share).
float closed_share(vec2 xy) {
#if SPECIES_MAP > 0
    return section_at(xy) > 0.0 ? 1.0 : 1.0 / (1.0 + 0.47 * (float(SPECIES_MAP) - 2.0));
#else
    return 1.0;
#endif
}

// One voxel of a level, nearest to a place (u, v, h): red green, blue opacity, foot x y, distance wood, two bytes a channel.
// Coarser levels halve its sides, not its height; opacity stays that of one voxel's length of the finest.
// Of the finest level every tree is asked whether it stands; coarser ones are of the canopy that stands at xy.
vec4 voxel_at(vec2 xy, vec3 place, float level) {
    float layer = place.z * canopy_height / voxel_size - 0.5;
    vec4 voxel = textureLod(pattern_voxels, vec3(place.xy, layer), level);
#if SPECIES_MAP > 0
    float layers = floor(canopy_height / voxel_size + 0.5);
    float held = section_at(xy) * layers + clamp(floor(layer + 0.5), 0.0, layers - 1.0);
    vec4 coarse = textureLod(species_voxels, vec3(place.xy, held), max(level - 1.0, 0.0));
    voxel = level > 0.5 ? coarse : voxel;
#endif
    return voxel * 65535.0;
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

// What share of a stand's trees must stand at the foot of one for it to be among them: its rank, of 128 in which the stand is thinned,
// from the byte that marks it. Under a species map each species has a band of 32 ranks, and stands only where the map's texel at its
// foot has its number or 0.
float rank_of(vec2 foot, float mark) {
    float rank = mod(mark, 128.0) / 128.0;
#if SPECIES_MAP > 0
    float wanted = floor(textureLod(species, terrain_coordinate(foot), 0.0).r * 255.0 + 0.5);
    float own = floor(rank * 4.0) + 1.0;
    rank = wanted == 0.0 || wanted == own ? fract(rank * 4.0) : 2.0;
#endif
    return rank;
}

// Whether the tree that owns the voxel stands, 0 or 1, and how far off the next one may be [m].
vec2 stand_of(vec2 xy, vec4 voxel) {
    vec2 foot = foot_of(xy, voxel);
    vec2 found = cover_at(foot);
    return vec2(found.x > rank_of(foot, two_bytes(voxel.w).y) ? 1.0 : 0.0, found.y);
}

// Slow variation of the trees' colour, from the foot of each tree.
float tint_of(vec2 foot) {
    return sin(foot.x * 0.37 + 1.3 * sin(foot.y * 0.11)) * sin(foot.y * 0.41 + 1.7 * sin(foot.x * 0.13));
}
