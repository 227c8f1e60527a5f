// The ground: the land round the site on the sphere, and the light that it sends back.
//
// What a ray finds of it is traced once for all suns. It does not know caves, overhangs or water that mirrors.
// land_heights  m above the sphere, nodes land_cell apart round the site    globe_albedo  root of the Earth's albedo, by
// longitude and latitude    land_tops  highest land of each node's cell, and of 2 x 2 of those
// at each coarser level
//   land_horizon  ba: sines of the layer's horizon, at two heights; r: sine of the elevation above which each node of
// the land sees the sun, g: share of an even sky's light that reaches it

#include "lib/patches.glsl"

vec2 land_place(vec2 place) {
    float size = float(textureSize(land_heights, 0).x);
    return (place / land_cell + 0.5 * size) / size;
}

float land_height(vec2 place) {
    return textureLod(land_heights, land_place(place), 0.0).r;
}

// Distance along a ray to the ground, m; NEVER where it meets none. footprint: width of the ray at one metre. first: m, before
// which it meets no land.
float ground_distance(Path path, vec3 origin, vec3 direction, float footprint, float first) {
    float end = sphere_distance(path);
#if LAND == 0
    return end;
#endif
    if (first >= end) return end;
    // The stretch of the ray between the land's top and the sphere, over the land's square.
    vec2 roof = path_distances(path, land_top);
    float half_side = 0.5 * land_cell * float(textureSize(land_heights, 0).x);
    vec2 to_sides = (sign(direction.xy) * half_side - origin.xy) / (abs(direction.xy) + 1.0e-9) * sign(direction.xy);
    vec2 from_sides = (-sign(direction.xy) * half_side - origin.xy) / (abs(direction.xy) + 1.0e-9) * sign(direction.xy);
    float t = max(max(roof.x, first), max(from_sides.x, from_sides.y));
    float stop = min(min(end, roof.y), min(to_sides.x, to_sides.y));
    float size = float(textureSize(land_heights, 0).x), found = NEVER;
    vec2 speed = direction.xy / land_cell; // nodes per metre
    speed = mix(speed, vec2(1.0e-9), lessThan(abs(speed), vec2(1.0e-9)));
    int level = first > 0.0 ? 0 : LAND_COARSEST;
    for (int k = 0; k < LAND_STEPS; k++) {
        if (t >= stop || found < NEVER) break;
        // From node to node: between two, the land is smooth, and both are in the cell's texel of land_tops.
        vec2 at = land_place(place_of(origin + t * direction)) * size - 0.5;
        float side = float(1 << level);
        vec2 cell = floor(at / side);
        vec2 ahead = ((cell + step(0.0, speed)) * side - at) / speed;
        // A little more than to the cell's edge, so that the next step is in the next cell.
        float until = min(t + max(min(ahead.x, ahead.y), 0.0) + 0.02 * land_cell, stop);
        float top = texelFetch(land_tops, clamp(ivec2(cell), ivec2(0), ivec2(int(size) >> level) - 1), level).r;
        bool clear = path_altitude(path, clamp(-path.along, t, until)) > top;
        bool fine = level == 0 || side * land_cell < footprint * t;
        float gap = path_altitude(path, t) - land_height(place_of(origin + t * direction));
        float gap_until = path_altitude(path, until) - land_height(place_of(origin + until * direction));
        if (!clear && fine && gap_until <= 0.0) found = gap <= 0.0 ? t : mix(t, until, gap / max(gap - gap_until, 1.0e-6));
        if (clear || fine) t = until;
        level = clear ? min(level + 1, LAND_COARSEST) : max(level - 1, 0);
    }
    // A ray that still hugs the land when its steps are spent meets it there: sky would show through the foot of mountains.
    return min(t < stop ? min(found, t) : found, end);
}

// Unit normal of the land at a place, in the site's axes turned to the point's own up.
vec3 land_normal(vec2 place, vec3 up) {
#if LAND == 0
    return up;
#endif
    vec2 node = vec2(land_cell, 0.0);
    vec2 rise = vec2(land_height(place + node.xy) - land_height(place - node.xy),
                     land_height(place + node.yx) - land_height(place - node.yx)) / (2.0 * land_cell);
    return normalize(up - vec3(rise, 0.0));
}

// Albedo of the ground at a point: the site's near by, the Earth's far away, snow above its line.
vec3 ground_albedo(vec3 point, vec3 up, vec2 place, float altitude, float footprint) {
    vec3 earth = vec3(dot(up, globe_east), dot(up, globe_north), dot(up, globe_up)); // x to 0 E on the equator, z to the pole
    vec2 at = vec2(atan(earth.y, earth.x) / (2.0 * AIR_PI) + 0.5, asin(clamp(earth.z, -1.0, 1.0)) / AIR_PI + 0.5);
    float texel = 2.0 * AIR_PI * planet_radius / float(textureSize(globe_albedo, 0).x);
    vec3 wide = textureLod(globe_albedo, at, log2(max(footprint / texel, 1.0))).rgb;
    float site = 1.0 - smoothstep(0.8, 1.2, length(place) / planet_site_size);
    vec3 near = mix(planet_albedo, planet_snow_albedo, smoothstep(-60.0, 60.0, altitude - planet_snow_line));
    return mix(wide * wide, near, site);
}

// What the land adds to that: rock where it is too steep for soil and snow, and patches, lost where a pixel is wider than they.
vec3 land_albedo(vec3 albedo, vec3 normal, vec3 up, vec2 place, float footprint) {
    vec2 turned = vec2(0.8 * place.x - 0.6 * place.y, 0.6 * place.x + 0.8 * place.y);
    vec3 octaves = vec3(patch_octave(place / 610.0, 7u), patch_octave(turned / 170.0, 8u), patch_octave(place / 47.0, 9u));
    float rough = dot(octaves, vec3(0.45, 0.35, 0.2) * clamp(2.0 - footprint / vec3(305.0, 85.0, 23.0), 0.0, 1.0));
    float site = 1.0 - smoothstep(0.8, 1.2, length(place) / planet_site_size);
    float holds = cos(planet_steepest), level = dot(normal, up) + 0.12 * rough;
    vec2 inside = step(abs(land_place(place) - 0.5), vec2(0.5));
    float rock = smoothstep(holds + 0.03, holds - 0.03, level) * inside.x * inside.y;
    return mix(albedo, planet_rock_albedo, rock) * (1.0 + 0.25 * site * rough * (1.0 - albedo));
}

// Shares of the sun's disc and of an even sky that the land leaves to its nodes; mu: the sun's zenith cosine.
vec2 land_sees(vec2 place, float mu) {
#if LAND == 0
    return vec2(1.0);
#endif
    vec2 found = textureLod(land_horizon, land_place(place), 0.0).rg;
    float horizon = found.r;
    vec2 inside = step(abs(land_place(place) - 0.5), vec2(0.5));
    // Near the horizon, where it matters, a sine is its angle.
    float t = clamp((mu - horizon) / (2.0 * SUN_RADIUS * sqrt(max(1.0 - mu * mu, 1.0e-4))) + 0.5, 0.0, 1.0);
    return mix(vec2(1.0), vec2(t * t * (3.0 - 2.0 * t), found.g), inside.x * inside.y);
}

// Share of the sun's disc that summits leave to the upper side of a layer of some thickness (m) over a place.
const float LAYER_LOW = 0.5, LAYER_HIGH = 2.0;
float layer_sees_sun(vec2 place, float thickness, float mu) {
#if LAND == 0
    return 1.0;
#endif
    vec2 found = textureLod(land_horizon, land_place(place), 0.0).ba;
    float share = thickness / max(layer_thickness, 1.0e-3);
    float horizon = mix(found.x, found.y, clamp((share - LAYER_LOW) / (LAYER_HIGH - LAYER_LOW), 0.0, 1.0));
    vec2 inside = step(abs(land_place(place) - 0.5), vec2(0.5));
    float t = clamp((mu - horizon) / (4.0 * SUN_RADIUS) + 0.5, 0.0, 1.0);
    return mix(1.0, t * t * (3.0 - 2.0 * t), inside.x * inside.y);
}

// Before what distance the rays of a pixel's block and of those around it meet no land, m: a little nearer than their nearest
// ray did. Ridges narrower than a block, against the sky, may lose a pixel.
float scouted(ivec2 pixel) {
#if LAND == 0
    return 0.0;
#endif
    ivec2 block = pixel / LAND_BLOCK, last = textureSize(traced_scout, 0) - 1;
    float nearest = NEVER;
    for (int k = 0; k < 9; k++)
        nearest = min(nearest, texelFetch(traced_scout, clamp(block + ivec2(k % 3, k / 3) - 1, ivec2(0), last), 0).r);
    return nearest < NEVER ? 0.985 * nearest : NEVER;
}
