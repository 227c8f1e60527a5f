// Depth pass of the depth shadow map. Williams 1978; Cohen 2004, section 5.1 (alpha test at 0.3).
// Symbols: pixel texel of the map, centres at half integers; shadow_corner [m], shadow_right, shadow_up window sides [m];
// the result is the distance [m] from the window's plane to the first voxel of opacity >= shadow_threshold, or to the ground.
// Deviations: the voxels are met by a walk along the sun's ray instead of by rasterised sheets, at the mip level of a texel's width.

#include "forest/world.glsl"
#include "forest/crossing.glsl"

vec4 shadow_depth_texel(vec2 pixel) {
    vec2 place = pixel / shadow_resolution;
    vec3 origin = shadow_corner + place.x * shadow_right + place.y * shadow_up;
    vec3 direction = -sun_direction;
    float t = canopy_entry(origin, direction, scene_entry(origin, direction));
    if (t < 0.0) return vec4(1e9);
    float level = floor(clamp(log2(length(shadow_right) / (shadow_resolution * voxel_size)), 0.0, 5.0) + 0.5);
    float ds = 0.5 * voxel_size * exp2(level);
    float previous = t;
    float rate = voxel_rate(direction) * exp2(-level);
    for (int i = 0; i < MARCH_STEPS; i++) {
        vec3 p = origin + t * direction;
        vec3 ground = ground_at(p.xy);
        float above = p.z - ground.x;
        if (above <= 0.0) return vec4(ground_crossing(origin, direction, previous, t));
        previous = t;
        float gap = above - canopy_top;
        if (gap > 0.0) {
            if (t > scene_reach + length(origin - shadow_corner)) break;
            t += max(step_above(gap, direction, ground), ds);
            continue;
        }
        float layer = layer_height(p.xy);
        float h = clamp(above / layer, 0.0, 1.0);
        vec4 voxel = voxel_at(vec3(atlas_coordinate(p.xy), h), level);
        vec2 stand = stand_of(p.xy, voxel);
        if (above <= layer && opacity_of(voxel) * stand.x >= shadow_threshold) return vec4(t);
        // No skip passes through the ground: a brink may stand in an empty canopy.
        float skip = max((free_voxels(voxel) - 1.0) / rate, stand.y - GLADE_REACH);
        t += max(min(skip, step_above(above, direction, ground)), ds);
    }
    return vec4(1e9);
}
