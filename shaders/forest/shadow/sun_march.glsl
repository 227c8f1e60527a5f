// Marching the sun's ray through the canopy. Levoy 1990 (early stop); Crassin et al. 2011, section 5 (voxels as wide as the cone); formulas g.
// Symbols: alpha opacity for one voxel of the level; ds step [m]; tau optical depth, in powers of two; T transmittance 2^-tau;
// shadow_voxels opacity, foot east and north, rank of the tree, four bytes of what pattern_voxels holds;
// shadow_land heights [m] below which the land alone hides the sun, and above which nothing does (land_shadow.py), swept for the sun.
// Steps are shadow_step voxels long and, after the first 32, grow by shadow_growth each, and the mip level with them; empty voxels and
// glades are skipped. Each step is read at one random place in it, whose mean over rays is the sum along the ray.
// A ray that has left the canopy between the two heights is followed, by safe steps, to where it may meet it again: the crowns of a
// ridge far off let through what they let through.
// Does not claim: a step's one voxel stands for all its length, so that a canopy of few opaque voxels lets a little too much light pass.

#include "forest/crossing.glsl"

// Times that a ray may leave the canopy and meet it again: over one ridge after the other, and, under a low sun, over every
// fold of a slope that it skims.
const int VISITS = 64;

// Height [m] over the canopy's top at which a ray counts as away: more than that at which canopy_entry has it there again, by
// as much as a skimmed slope is uneven.
const float AWAY = 2.0;

// Farthest [m] that a tree's voxels lie from its foot: 8 m along either axis.
const float CROWN_REACH = 11.4;

// Steps of the first length, before they grow: the crown itself and its neighbours.
const int EVEN_STEPS = 32;

// Longest step, of the pattern's voxels.
const float LONGEST = 8.0;

// By how much [m] a ray must pass the swept heights, which are known at the terrain's nodes, to be believed: over the one that
// hides nothing, and under the one that hides all, which jumps from line to line where a ridge ends.
const float BOUND_MARGIN = 0.5;
const float SURE_MARGIN = 2.0;

// Interleaved gradient noise of Jimenez 2014 from pixel to pixel, turned by the R5 sequence of Roberts 2018 from sample to sample.
vec4 sun_jitter() {
    float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    return fract(noise * vec4(1.0, 5.0, 11.0, 23.0) + sample_shift * vec4(0.8812714616, 0.7766393890, 0.6844301295, 0.6031687406));
}

// What becomes of a ray that has left the canopy at p: 1 nothing hides the sun, -1 the land does, 0 it may meet the canopy again,
// as it may anywhere beyond the square, whose edge continues without end.
float over_land(vec3 p) {
    float half_side = 0.5 * terrain_cell * (terrain_nodes - 1.0);
    vec2 bounds = textureLod(shadow_land, terrain_coordinate(p.xy), 0.0).rg;
    float known = p.z > bounds.y + BOUND_MARGIN ? 1.0 : p.z < bounds.x - SURE_MARGIN ? -1.0 : 0.0;
    return max(abs(p.x), abs(p.y)) > half_side ? 0.0 : known;
}

// Formulas g: tau = -sum log2(1 - alpha) ds / voxel.
float shadow_visibility(vec3 position, float h, vec2 uv) {
    vec4 jitter = sun_jitter();
    vec3 offset = voxel_offset(jitter);
    float reach = 1.0 / voxel_rate(sun_direction);
    // What a ray rises over the steepest ground: no skip passes through it.
    float grade = 1.0 / max(terrain_steepness * length(sun_direction.xy) - sun_direction.z, 1e-4);
    float limit = -log2(max(shadow_stop, 1e-6));
    float width = shadow_step;
    float start = 0.0;
    float tau = sun_elevation > 0.0 ? 0.0 : 100.0;
    for (int visit = 0; visit < VISITS; visit++) {
        vec3 p = position;
        for (int i = 0; i < MARCH_STEPS; i++) {
            float ds = width * voxel_size;
            p = position + (start + jitter.x * ds) * sun_direction;
            float above = p.z - ground_height(p.xy);
            float level = clamp(floor(log2(width) + shadow_bias + jitter.z), 0.0, 5.0);
            float scale = exp2(level);
            float rise = above / layer_height(p.xy);
            vec4 voxel = textureLod(shadow_voxels, vec3(atlas_coordinate(p.xy), rise) + scale * offset, level) * 255.0;
            bool empty = voxel.x == 0.0;
            vec2 away = empty ? vec2(0.0) : (voxel.yz - 128.0) * 0.0625;
            vec2 stand = cover_at(p.xy + away);
            bool met = rise < 1.0 && stand.x > rank_of(p.xy + away, voxel.w);
            tau += above < 0.0 ? 100.0 : met ? -log2(1.0 - min(voxel.x / 255.0, 0.99975586)) * width / scale : 0.0;
            if (above > canopy_top + AWAY || tau > limit) break;
            float free = max(empty ? (voxel.y - 1.0) * scale * reach : 0.0, stand.y - length(away) - CROWN_REACH);
            start += max(ds, min(free, above * grade));
            width = i < EVEN_STEPS ? width : min(width * (1.0 + shadow_growth), LONGEST);
        }
        float over = over_land(p);
        tau += over < 0.0 ? 100.0 : 0.0;
        if (over != 0.0 || tau > limit) break;
        start = canopy_entry(position, sun_direction, start + jitter.x * width * voxel_size);
        if (start < 0.0) break;
    }
    return tau > limit ? 0.0 : exp2(-tau);
}
