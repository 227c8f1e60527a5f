// The air seen from one place, as two small tables that a frame reads instead of walking each ray.
//
// Hillaire 2020, sections 5.3 and 5.4 (sky view and aerial perspective). Rows: angle from the horizon, half of them above it,
// by its square; columns of a slice: azimuth from the sun, by its square; slices: shares of the way, as `air_share` counts.
//   air_up, air_ahead  the camera's own up, and level towards the sun; air_horizon, air_limb  angles from the zenith (rad) of
//   the horizon and of the first ray that meets air
//   air_light   AIR_SLICES slices side by side: what the air from the eye to a slice sends, W m-2 sr-1
//   air_passed  one column a slice: its optical depth
// It does not claim to serve rays that do not start at the camera: a parallel view walks each of its rays.

const float AIR_AROUND = 24.0, AIR_ROWS = 64.0;

// Direction and half (0 above the horizon, 1 below) of a row and a column, both counted in texels from 0.
vec3 air_direction(float row, float column, out bool below) {
    float rows = 0.5 * AIR_ROWS;
    below = row >= rows;
    float x = (below ? row - rows : row) / (rows - 1.0);
    float zenith = below ? air_horizon + (AIR_PI - air_horizon) * x * x : air_horizon - (air_horizon - air_limb) * x * x;
    float azimuth = column / (AIR_AROUND - 1.0);
    azimuth *= azimuth * AIR_PI;
    return cos(zenith) * air_up + sin(zenith) * (cos(azimuth) * air_ahead + sin(azimuth) * cross(air_up, air_ahead));
}

// The texel of `air_light` that gl_FragCoord names, or of `air_passed`, whose columns are slices.
vec3 air_texel(vec2 fragment, bool light) {
    vec2 texel = floor(fragment);
    float slice = light ? floor(texel.x / AIR_AROUND) : texel.x;
    float column = light ? texel.x - slice * AIR_AROUND : 0.0;
    bool below;
    vec3 direction = air_direction(texel.y, column, below);
    Path path = path_of(camera_origin, direction);
    AirRay ray = air_ray(path, below ? sphere_distance(path) : NEVER);
    vec3 depth;
    vec3 sent = air_between(path, ray, camera_origin, direction, vec2(0.0, slice / (AIR_SLICES - 1.0)), int(slice), depth);
    return light ? sent : depth;
}
