// Marching the sun's ray through the canopy. Levoy 1990 (early stop); Crassin et al. 2011, section 5 (voxels as wide as the cone); formulas g.
// Symbols: alpha opacity for one voxel of the level; ds step [m]; tau optical depth, in powers of two; T transmittance 2^-tau;
// shadow_voxels opacity, foot east and north, rank of the tree, four bytes of what pattern_voxels holds.
// Steps begin at shadow_step voxels and grow by shadow_growth each, and the mip level with them. Each is read at one random place in it, whose mean over rays is the sum along the ray.
// Land: where the ray leaves the canopy it must pass over the shadow of land and stands (land_shadow.py), which is swept for the sun.
// Does not claim: a step's one voxel stands for all its length, so that a canopy of few opaque voxels lets a little too much light pass.

#include "forest/land_shadow.glsl"

// Interleaved gradient noise of Jimenez 2014 from pixel to pixel, turned by the R5 sequence of Roberts 2018 from sample to sample.
vec4 sun_jitter() {
    float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    return fract(noise * vec4(1.0, 5.0, 11.0, 23.0) + sample_shift * vec4(0.8812714616, 0.7766393890, 0.6844301295, 0.6031687406));
}

// Formulas g: tau = -sum log2(1 - alpha) ds / voxel.
float shadow_visibility(vec3 position, float h, vec2 uv) {
    vec4 jitter = sun_jitter();
    vec3 offset = voxel_offset(jitter);
    float ds = shadow_step * voxel_size;
    float limit = -log2(max(shadow_stop, 1e-6));
    float start = 0.0;
    float tau = 0.0;
    vec3 p = position;
    for (int i = 0; i < MARCH_STEPS; i++) {
        p = position + (start + jitter.x * ds) * sun_direction;
        float above = p.z - ground_height(p.xy);
        float level = clamp(floor(log2(ds / voxel_size) + shadow_bias + jitter.z), 0.0, 5.0);
        float scale = exp2(level);
        float layer = layer_height(p.xy);
        vec3 place = vec3(atlas_coordinate(p.xy), above / layer) + scale * offset;
        vec4 voxel = textureLod(shadow_voxels, place, level);
        vec2 foot = p.xy + (voxel.yz * 255.0 - 128.0) * 0.0625;
        float matter = above < layer && cover_at(foot).x > mod(voxel.w * 255.0, 128.0) / 128.0 ? voxel.x : 0.0;
        tau = above < 0.0 ? 100.0 : tau - log2(1.0 - min(matter, 0.99975586)) * ds / (scale * voxel_size);
        if (above > canopy_top || tau > limit) break;
        start += ds;
        ds *= 1.0 + shadow_growth;
    }
    return tau > limit ? 0.0 : exp2(-tau) * over_land(p);
}
