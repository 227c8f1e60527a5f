// Directions of a hemisphere, numbered row by row from the horizon up, the zenith last (16 x 8 + 1 = 129).
//
// Porquet 2005, section on self-shadowing; renderer/directional/hemisphere.py has the twin and the layout.
//   elevations <-> rows, azimuths <-> directions of a row, step = (pi/2) / (elevations + 1/2) [rad]
// No claim: a direction below the horizon counts as level.

const float HALF_PI = 1.57079632679;
const float TURN = 6.28318530718;

// Row coordinate [steps from the horizon] and azimuth coordinate [parts of a row] of a unit direction.
vec2 hemisphere_place(vec3 direction, int azimuths, int elevations) {
    // By the arc tangent: drivers' arc sines err by 1e-4.
    float height = atan(max(direction.z, 0.0), length(direction.xy)) * (float(elevations) + 0.5) / HALF_PI;
    float turn = dot(direction.xy, direction.xy) > 0.0 ? atan(direction.y, direction.x) / TURN : 0.0;
    return vec2(height, fract(turn) * float(azimuths));
}

// Number of the direction at a row and an azimuth, which wraps; any row beyond the last is the zenith.
int hemisphere_index(int row, int azimuth, int azimuths, int elevations) {
    int wrapped = azimuth - azimuths * int(floor(float(azimuth) / float(azimuths)));
    return row >= elevations ? azimuths * elevations : max(row, 0) * azimuths + wrapped;
}

// Number of the cell that a unit direction lies in.
int hemisphere_nearest(vec3 direction, int azimuths, int elevations) {
    vec2 place = hemisphere_place(direction, azimuths, elevations);
    return hemisphere_index(int(place.x), int(place.y + 0.5), azimuths, elevations);
}

// The four directions round a unit direction, and their bilinear weights, 1 together. Below the lowest row it counts as
// being on it.
void hemisphere_around(vec3 direction, int azimuths, int elevations, out ivec4 around, out vec4 weights) {
    vec2 place = hemisphere_place(direction, azimuths, elevations);
    float row = clamp(place.x - 0.5, 0.0, float(elevations));
    int low = min(int(row), elevations - 1);
    int left = int(place.y);
    vec2 along = vec2(row - float(low), place.y - float(left));
    around = ivec4(hemisphere_index(low, left, azimuths, elevations),
                   hemisphere_index(low, left + 1, azimuths, elevations),
                   hemisphere_index(low + 1, left, azimuths, elevations),
                   hemisphere_index(low + 1, left + 1, azimuths, elevations));
    weights = vec4((1.0 - along.x) * vec2(1.0 - along.y, along.y), along.x * vec2(1.0 - along.y, along.y));
}

// The four directions round a unit direction with their weights, and how far along u and v each runs for one along the
// normal.
void hemisphere_slants(vec3 direction, int azimuths, int elevations, out ivec4 around, out vec4 weights, out vec4 u,
                       out vec4 v) {
    hemisphere_around(direction, azimuths, elevations, around, weights);
    int zenith = azimuths * elevations;
    vec2 row = vec2(around.xz / azimuths);
    vec2 elevation = (row + 0.5) * HALF_PI / (float(elevations) + 0.5);
    vec2 slant = vec2(cos(elevation.x) / sin(elevation.x), around.z == zenith ? 0.0 : cos(elevation.y) / sin(elevation.y));
    vec2 turn = vec2(around.xy % azimuths) * (TURN / float(azimuths));
    u = slant.xxyy * cos(turn).xyxy;
    v = slant.xxyy * sin(turn).xyxy;
}

// Unit direction of a number.
vec3 hemisphere_direction(int index, int azimuths, int elevations) {
    bool zenith = index == azimuths * elevations;
    float elevation = (float(index / azimuths) + 0.5) * HALF_PI / (float(elevations) + 0.5);
    float turn = float(index % azimuths) * TURN / float(azimuths);
    return zenith ? vec3(0.0, 0.0, 1.0) : vec3(cos(elevation) * vec2(cos(turn), sin(turn)), sin(elevation));
}
