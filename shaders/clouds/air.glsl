// The clear air between any two points of a ray, from the ground to space.
//
// Hillaire 2020, "A Scalable and Production Ready Sky and Atmosphere Rendering Technique"; tables of
// renderer/world/atmosphere.py, made by renderer/clouds/air.py:
//   air_beam   share of the sun's light that arrives; rows: height, columns: the sun's zenith cosine above the horizon's
//   air_glow   light scattered twice or more, W m-2 sr-1; rows: height, columns: the sun's zenith cosine
//   air_skylight  irradiance of level ground by the clear sky, W m-2; columns: the sun's elevation
// Lengths are km in here, altitudes are m outside. Deviation: heights over planet_radius stand for heights over AIR_GROUND.

const float AIR_GROUND = 6360.0, AIR_TOP = 6460.0; // km
const float AIR_MARGIN = 0.01; // of the beam's table below the horizon, where the disc is still half up
const float AIR_DARKEST = 80.0;
const vec3 AIR_RAYLEIGH = vec3(5.802e-3, 13.558e-3, 33.100e-3); // km-1
const vec3 AIR_OZONE = vec3(0.650e-3, 1.881e-3, 0.085e-3);      // km-1
const float AIR_MIE = 3.996e-3, AIR_MIE_LOST = 4.44e-3;         // km-1, scattering and extinction of haze
const vec2 AIR_HEIGHTS = vec2(8.0, 1.2);                         // km, over which molecules and haze thin out by e
const float AIR_PI = 3.14159265358979;
const float SUN_RADIUS = 0.00465305; // rad

float air_root(float x) {
    return sign(x) * sqrt(abs(x));
}

// Share of the sun's light that arrives at an altitude (m) from a zenith cosine, the planet's shadow included.
vec3 sun_through_air(float altitude, float mu) {
    float height = clamp(0.001 * altitude, 0.0, AIR_TOP - AIR_GROUND);
    float dip = sqrt(height * (2.0 * AIR_GROUND + height)) / (AIR_GROUND + height); // sine of the horizon's dip
    float above = (mu + dip) / (1.0 + dip);
    vec2 place = vec2(sqrt(max(above + AIR_MARGIN, 0.0) / (1.0 + AIR_MARGIN)), sqrt(0.01 * height));
    vec2 size = vec2(textureSize(air_beam, 0));
    return textureLod(air_beam, (min(place, 1.0) * (size - 1.0) + 0.5) / size, 0.0).rgb;
}

vec3 air_glow_at(float altitude, float mu) {
    const float lowest = -0.591607978; // signed root of -0.35
    vec2 place = vec2((air_root(mu) - lowest) / (1.0 - lowest), sqrt(clamp(1.0e-5 * altitude, 0.0, 1.0)));
    vec2 size = vec2(textureSize(air_glow, 0));
    return textureLod(air_glow, (clamp(place, 0.0, 1.0) * (size - 1.0) + 0.5) / size, 0.0).rgb;
}

// Irradiance of level ground by the clear sky, W m-2, under a sun of that zenith cosine.
vec3 air_skylight_at(float mu) {
    float x = 0.5 + 0.5 * air_root(asin(clamp(mu, -1.0, 1.0)) / (0.5 * AIR_PI));
    float size = float(textureSize(air_skylight, 0).x);
    return textureLod(air_skylight, vec2((x * (size - 1.0) + 0.5) / size, 0.5), 0.0).rgb;
}

// Density of molecules and of haze against that on the ground, at an altitude in m.
vec2 air_density(float altitude) {
    return exp(-max(0.001 * altitude, 0.0) / AIR_HEIGHTS);
}

// Of molecules and haze of some density, and of the ozone at an altitude (m), km-1.
vec3 air_extinction(vec2 density, float altitude, out vec3 rayleigh, out float mie) {
    rayleigh = AIR_RAYLEIGH * density.x;
    float particles = air_haze * density.y;
    mie = AIR_MIE * particles;
    return rayleigh + AIR_MIE_LOST * particles + AIR_OZONE * max(0.0, 1.0 - abs(0.001 * altitude - 25.0) / 15.0);
}

// The part of a ray that lies in the air, and how its points are spread: close where light changes along it. From a camera low
// in the air that is near by, where land stands before the sky: points lie by the square of their share up to the horizon, the
// same on both sides of it, and evenly behind. From above it is where the ray comes nearest to the ground.
struct AirRay {
    float start;  // m
    float end;
    float lowest; // m, where it comes nearest to the ground, or as far as the horizon
    float before; // roots of the lengths before and behind that point
    float behind;
    bool near;
};

const float AIR_POWER = 2.5;
const float AIR_LOW = 6000.0;                    // m, up to which a camera is low in the air
const float AIR_NEAR = 8.0e4, AIR_SPLIT = 2.0 / 3.0; // m, least length of the part spread by squares; its share of the points

// stop: m, where the ground ends the ray; NEVER where it does not.
AirRay air_ray(Path path, float stop) {
    vec2 ends = path_distances(path, AIR_CEILING);
    float start = max(ends.x, 0.0), end = max(min(ends.y, stop), start);
    if (path.altitude < AIR_LOW) {
        float horizon = sqrt(max(path.excess, 0.0));
        return AirRay(0.0, end, min(end, max(horizon, AIR_NEAR)), 0.0, 0.0, true);
    }
    float lowest = clamp(-path.along, start, end);
    return AirRay(start, end, lowest, pow(lowest - start, 1.0 / AIR_POWER), pow(end - lowest, 1.0 / AIR_POWER), false);
}

// Distance (m) of the point at a share of the way, and the other way round.
float air_distance(AirRay ray, float share) {
    if (ray.near) {
        float s = min(share / AIR_SPLIT, 1.0);
        return ray.lowest * s * s + (ray.end - ray.lowest) * max(share - AIR_SPLIT, 0.0) / (1.0 - AIR_SPLIT);
    }
    float s = mix(-ray.before, ray.behind, share);
    return ray.lowest + sign(s) * pow(abs(s), AIR_POWER);
}

float air_share(AirRay ray, float t) {
    if (ray.near) {
        float s = sqrt(clamp(t / max(ray.lowest, 1.0), 0.0, 1.0));
        return AIR_SPLIT * s + (1.0 - AIR_SPLIT) * clamp((t - ray.lowest) / max(ray.end - ray.lowest, 1.0), 0.0, 1.0);
    }
    float from = clamp(t, ray.start, ray.end) - ray.lowest;
    float s = sign(from) * pow(abs(from), 1.0 / AIR_POWER);
    return clamp((s + ray.before) / max(ray.before + ray.behind, 1.0e-20), 0.0, 1.0);
}

// What the air between two shares of a ray sends to the first (W m-2 sr-1), and its optical depth.
vec3 air_between(Path path, AirRay ray, vec3 origin, vec3 direction, vec2 shares, int steps, out vec3 depth) {
    vec3 light = vec3(0.0);
    depth = vec3(0.0);
    float facing = dot(direction, sun_direction);
    float sunward = dot(origin, sun_direction) + planet_radius * sun_direction.z;
    const float g = 0.8;
    vec2 phases = 3.0 / (8.0 * AIR_PI) * (1.0 + facing * facing)
        * vec2(0.5, (1.0 - g * g) / (2.0 + g * g) * pow(1.0 + g * g - 2.0 * g * facing, -1.5));
    float from = air_distance(ray, shares.x), high = path_altitude(path, from);
    vec2 density = air_density(high);
    for (int k = 1; k <= steps; k++) {
        float to = air_distance(ray, mix(shares.x, shares.y, float(k) / float(steps)));
        float t = 0.5 * (from + to);
        float altitude = path_altitude(path, t), next = path_altitude(path, to);
        // Mean over the step of a density that falls exponentially: a step may be longer than the haze is deep.
        vec2 beyond = air_density(next);
        vec2 mean = abs(next - high) > 50.0 ? abs(1000.0 * AIR_HEIGHTS * (density - beyond) / (next - high)) : 0.5 * (density + beyond);
        vec3 rayleigh;
        float mie;
        vec3 extinction = air_extinction(mean, altitude, rayleigh, mie);
        float mu = (sunward + t * facing) / (planet_radius + altitude);
        vec3 source = sun_irradiance * sun_through_air(altitude, mu) * (rayleigh * phases.x + mie * phases.y)
            + air_glow_at(altitude, mu) * (rayleigh + mie);
        vec3 lost = extinction * (0.001 * (to - from));
        light += exp(-min(depth, AIR_DARKEST)) * source * (1.0 - exp(-min(lost, AIR_DARKEST))) / max(extinction, 1.0e-12);
        depth += lost;
        from = to;
        high = next;
        density = beyond;
    }
    return light;
}
