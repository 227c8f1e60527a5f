// Pass of the Fourier opacity map: gathers the series of the extinction along one line of the sun's light. Jansen & Bavoil 2010, section 3.
// Symbols: line coordinates across the light, along shadow_right and shadow_up [m]; texel its texel's width [m]; t way along it [m];
// d place on the crossing, 0 where the light first meets matter, 1 on the ground; alpha opacity for one voxel's length.
// a_0 = 2 tau, a_k = -2 sum ln(1 - alpha) cos(2 pi k d), b_k the same with the sine: the result is a_0, a_1, b_1, a_2, b_2 ..., four a
// texture, after the crossing's four sunward coordinates [m]: first matter, where the light leaves the canopy again, where it comes
// back to it for the last time, and the ground.
// Deviations: d runs over the canopy alone, where the paper's runs over the map's whole depth, which is a hundred times the canopy's;
// each step stands for its length (its box divides a wave by k pi w / sin k pi w), where the paper's particles are points.

#include "forest/world.glsl"
#include "forest/crossing.glsl"

const float NEVER = -1e9;

// In coarser levels a voxel is wider than a crown, and crowns and the light between them are one.
const float COARSEST = 3.0;

// Optical depth behind which the rest is dark, and does not count: less than a hundredth of the light; what is opaque would ring.
const float DARK = 5.0;

const int WAVES = (SHADOW_COEFFICIENTS - 1) / 2;

// Where a ray that enters the canopy's layer at t first leaves it upwards, comes into it for the last time, and meets the ground [m];
// where it only crosses once, it leaves on the ground. Without ground, z is -1.
vec3 crossing_of(vec3 origin, vec3 direction, float t) {
    float left = -1.0;
    float again = -1.0;
    bool was_over = false;
    int found = t < 0.0 ? 0 : 1;
    for (int i = 0; i < ENTRY_STEPS && found == 1; i++) {
        vec3 p = origin + t * direction;
        vec3 ground = ground_at(p.xy);
        float above = p.z - ground.x;
        bool over = above > canopy_top + 0.2 + ENTRY_TOLERANCE * t;
        left = over && left < 0.0 ? t : left;
        again = was_over && !over ? t : again;
        was_over = over;
        found = above <= 0.05 ? 2 : t > scene_reach || p.z < -100.0 ? 0 : 1;
        if (found == 1) t += max(0.1, step_above(over ? above - canopy_top : above, direction, ground));
    }
    return vec3(again < 0.0 ? t : left, again < 0.0 ? t : again, found == 0 ? -1.0 : t);
}

void shadow_waves_texel(vec2 pixel, out vec4 texels[1 + (SHADOW_COEFFICIENTS + 3) / 4]) {
    vec2 line = shadow_window.xy + pixel * shadow_window.zw;
    float texel = max(shadow_window.z, shadow_window.w);
    vec3 across = line.x * shadow_right + line.y * shadow_up;
    float begin = min((scene_top - across.z) / max(sun_direction.z, 1e-4), shadow_away);
    vec3 origin = across + begin * sun_direction;
    vec3 direction = -sun_direction;
    float t = canopy_entry(origin, direction, 0.0);
    vec3 crossing = crossing_of(origin, direction, t);
    // Steps begin anywhere in the first one, or their phase against the layers of voxels would draw contours on the slopes; and levels
    // are whole ones at random, or their borders would show.
    vec2 lattice = mod(floor(line / shadow_window.zw), 1024.0);
    vec2 noise = fract(52.9829189 * fract(dot(lattice, vec2(0.06711056, 0.00583715))) * vec2(1.0, 7.0));
    float level = floor(clamp(log2(texel / voxel_size) + shadow_level, 0.0, COARSEST) + noise.y);
    float ds = voxel_size * exp2(level);
    float rate = voxel_rate(direction);
    float values[SHADOW_COEFFICIENTS];
    for (int k = 0; k < SHADOW_COEFFICIENTS; k++) values[k] = 0.0;
    float first = NEVER;
    float range = 1.0;
    t += noise.x * ds;
    int found = crossing.z < 0.0 ? 0 : 1;
    for (int i = 0; i < MARCH_STEPS && found == 1; i++) {
        vec3 p = origin + t * direction;
        vec3 ground = ground_at(p.xy);
        float above = p.z - ground.x;
        float gap = above - canopy_top;
        bool over = gap > 0.0;
        float layer = layer_height(p.xy);
        vec4 voxel = voxel_at(p.xy, vec3(atlas_coordinate(p.xy), clamp(above / layer, 0.0, 1.0)), level);
        vec2 stand = stand_of(p.xy, voxel);
        float depth = above > layer ? 0.0 : -log(1.0 - opacity_of(voxel)) * ds / voxel_size * stand.x;
        found = above <= 0.0 || t >= crossing.z || values[0] >= 1.999 * DARK ? 2 : 1;
        if (found == 1) {
            if (depth > 0.0) {
                first = first == NEVER ? t - 0.5 * ds : first;
                range = max(crossing.z - crossing.y + max(crossing.x - first, 0.0), 0.1);
                float d = (clamp(t - first, 0.0, max(crossing.x - first, 0.0)) + max(t - crossing.y, 0.0)) / range;
                vec2 turn = vec2(cos(6.283185307179586 * d), sin(6.283185307179586 * d));
                vec2 wave = vec2(min(2.0 * depth, 2.0 * DARK - values[0]), 0.0);
                values[0] += wave.x;
                for (int k = 0; k < WAVES; k++) {
                    wave = vec2(wave.x * turn.x - wave.y * turn.y, wave.x * turn.y + wave.y * turn.x);
                    values[2 * k + 1] += wave.x;
                    values[2 * k + 2] += wave.y;
                }
            }
            // No skip passes through the ground: a brink may stand in an empty canopy.
            float skip = max((free_voxels(voxel) - 1.0) / rate, stand.y - GLADE_REACH);
            t += max(ds, over ? step_above(gap, direction, ground) : min(skip, step_above(above, direction, ground)));
        }
    }
    for (int k = 1; k <= WAVES; k++) {
        float x = min(3.141592653589793 * float(k) * ds / range, 3.0);
        float box = sin(x) / max(x, 1e-4);
        values[2 * k - 1] *= box;
        values[2 * k] *= box;
    }
    texels[0] = first == NEVER ? vec4(NEVER) : begin - vec4(first, max(crossing.x, first), max(crossing.y, first), crossing.z);
    for (int n = 0; n < (SHADOW_COEFFICIENTS + 3) / 4; n++) {
        for (int c = 0; c < 4; c++) texels[n + 1][c] = 4 * n + c < SHADOW_COEFFICIENTS ? values[min(4 * n + c, SHADOW_COEFFICIENTS - 1)] : 0.0;
    }
}
