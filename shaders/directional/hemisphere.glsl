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

// Lower row and left azimuth of the four directions round a unit direction, and where it lies between them. Below the
// lowest row it counts as being on it.
ivec2 hemisphere_cell(vec3 direction, int azimuths, int elevations, out vec2 along) {
    vec2 place = hemisphere_place(direction, azimuths, elevations);
    float row = clamp(place.x - 0.5, 0.0, float(elevations));
    ivec2 cell = ivec2(min(int(row), elevations - 1), int(place.y));
    along = vec2(row, place.y) - vec2(cell);
    return cell;
}

// The four directions round a unit direction, and their bilinear weights, 1 together.
void hemisphere_around(vec3 direction, int azimuths, int elevations, out ivec4 around, out vec4 weights) {
    vec2 along;
    ivec2 cell = hemisphere_cell(direction, azimuths, elevations, along);
    around = ivec4(hemisphere_index(cell.x, cell.y, azimuths, elevations),
                   hemisphere_index(cell.x, cell.y + 1, azimuths, elevations),
                   hemisphere_index(cell.x + 1, cell.y, azimuths, elevations),
                   hemisphere_index(cell.x + 1, cell.y + 1, azimuths, elevations));
    weights = vec4((1.0 - along.x) * vec2(1.0 - along.y, along.y), along.x * vec2(1.0 - along.y, along.y));
}

// How far along the first axis (u) and the second (v) the four directions of a cell run for one along the normal.
void hemisphere_slants(ivec2 cell, int azimuths, int elevations, out vec4 u, out vec4 v) {
    vec2 elevation = (vec2(cell.x, cell.x + 1) + 0.5) * (HALF_PI / (float(elevations) + 0.5));
    vec2 slant = cos(elevation) / sin(elevation);
    slant.y = cell.x + 1 == elevations ? 0.0 : slant.y; // the zenith
    vec2 turn = vec2(cell.y, cell.y + 1) * (TURN / float(azimuths));
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
