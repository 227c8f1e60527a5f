// Radiance of the clear sky, from the small picture of it that the CPU makes for each sun.
//
// Hillaire 2020, "A Scalable and Production Ready Sky and Atmosphere Rendering Technique", section 5.3 (sky-view table).
// Twin of `sky_radiance` in renderer/world/sky.py, which says what the picture holds.
//   e  elevation of a direction, rad        row    = sqrt(e / (pi/2)) (rows - 1)
//   a  its azimuth from the sun, rad        column = sqrt(a / pi) (columns - 1)
// Deviations: rows and columns are square roots of the angles from the horizon and from the sun; the picture ends at the
// horizon and is repeated below it. It does not claim to be seen from above the air.

const float SKY_PI = 3.14159265358979;
const float SKY_SUN_RADIUS = 0.00465305; // rad, 0.2666 degrees

// direction: unit vector. Returns W m-2 sr-1, without the sun's disc.
vec3 sky_radiance(vec3 direction) {
    vec2 size = vec2(textureSize(sky_view, 0));
    float level = length(direction.xy) * length(sky_sun_direction.xy);
    float cosine = dot(direction.xy, sky_sun_direction.xy) / max(level, 1e-6);
    vec2 place = sqrt(vec2(acos(clamp(cosine, -1.0, 1.0)) / SKY_PI, asin(clamp(direction.z, 0.0, 1.0)) / (0.5 * SKY_PI)));
    return textureLod(sky_view, (place * (size - 1.0) + 0.5) / size, 0.0).rgb;
}

// direction: unit vector. Returns W m-2 sr-1: the sun's disc above the horizon, of even brightness, and zero elsewhere.
// A chord keeps the precision that a cosine near one loses in float32.
vec3 sky_sun_disc(vec3 direction) {
    float chord = 2.0 * sin(0.5 * SKY_SUN_RADIUS);
    return length(direction - sky_sun_direction) < chord && direction.z > 0.0 ? sky_disc_radiance : vec3(0.0);
}
