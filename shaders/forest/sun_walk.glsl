// Where the sun's light first meets matter along one line of it: what every shadow map keeps. Williams 1978; Cohen 2004, section 5.1.
// Symbols: line coordinates of the line across the light, along shadow_right and shadow_up [m]; sunward p . sun_direction [m],
// greater nearer to the sun; texel width of the map's texel there [m]; threshold opacity [-] from which matter hides the sun.
// Deviations: the canopy is walked along the line instead of drawn as sheets, at the mip level of the texel's width; opacity is
// gathered on the way, because an alpha test of each voxel would mean something else at each level.

#include "forest/world.glsl"
#include "forest/crossing.glsl"

const float NEVER = -1e9;

// In coarser levels a voxel is wider than a crown, and crowns and the light between them are one.
const float COARSEST = 3.0;

float first_sunward(vec2 line, float texel, float threshold) {
    vec3 across = line.x * shadow_right + line.y * shadow_up;
    float begin = min((scene_top - across.z) / max(sun_direction.z, 1e-4), shadow_away);
    vec3 origin = across + begin * sun_direction;
    vec3 direction = -sun_direction;
    float t = canopy_entry(origin, direction, 0.0);
    float level = floor(clamp(log2(texel / voxel_size), 0.0, COARSEST) + 0.5);
    float ds = voxel_size * exp2(level);
    float rate = voxel_rate(direction);
    float wanted = -log(1.0 - threshold);
    float gathered = 0.0;
    float previous = t;
    float before = 0.0;
    float above = 0.0;
    int found = t < 0.0 ? 0 : 1;
    for (int i = 0; i < MARCH_STEPS && found == 1; i++) {
        vec3 p = origin + t * direction;
        vec3 ground = ground_at(p.xy);
        above = p.z - ground.x;
        before = i == 0 ? max(above, 0.0) : before;
        float gap = above - canopy_top;
        bool over = gap > 0.0;
        float layer = layer_height(p.xy);
        vec4 voxel = voxel_at(p.xy, vec3(atlas_coordinate(p.xy), clamp(above / layer, 0.0, 1.0)), level);
        vec2 stand = stand_of(p.xy, voxel);
        float depth = above > layer ? 0.0 : -log(1.0 - opacity_of(voxel)) * ds / voxel_size * stand.x;
        found = above <= 0.0 ? 2 : t > scene_reach ? 0 : gathered + depth >= wanted ? 3 : 1;
        if (found == 1) {
            gathered += depth;
            previous = t;
            before = above;
            // No skip passes through the ground: a brink may stand in an empty canopy.
            float skip = max((free_voxels(voxel) - 1.0) / rate, stand.y - GLADE_REACH);
            t += max(ds, over ? step_above(gap, direction, ground) : min(skip, step_above(above, direction, ground)));
        } else if (found == 3) {
            t += ds * ((wanted - gathered) / depth - 0.5);
        }
    }
    float met = found == 2 ? ground_crossing(origin, direction, vec2(previous, t), vec2(before, above)) : t;
    return found == 0 ? NEVER : begin - met;
}
