// Reading of the tables of air_table.glsl: where a ray stands in them, which no sun changes, and what they say.
// Symbols: look.x row over the rows' number less one, look.y azimuth from air_east towards the north in turns, half a turn added [-].

vec2 air_place(vec3 direction, bool ground) {
    float cosine = dot(direction, air_up);
    vec3 level = direction - cosine * air_up;
    float zenith = atan(length(level), cosine);
    float rows = 0.5 * AIR_ROWS;
    float x = ground ? (zenith - air_horizon) / (AIR_PI - air_horizon) : (air_horizon - zenith) / (air_horizon - air_limb);
    float row = sqrt(clamp(x, 0.0, 1.0)) * (rows - 1.0) + (ground ? rows : 0.0);
    return vec2(row / (AIR_ROWS - 1.0), atan(dot(level, cross(air_up, air_east)), dot(level, air_east)) / (2.0 * AIR_PI) + 0.5);
}

// Optical depth of the air from the eye to a share of the ray.
vec3 air_depth_to(vec4 look, float share) {
    vec2 at = vec2(share * (AIR_SLICES - 1.0), look.x * (AIR_ROWS - 1.0)) + 0.5;
    return textureLod(air_passed, at / vec2(AIR_SLICES, AIR_ROWS), 0.0).rgb;
}

// Light of the air from the eye to a share of the ray, W m-2 sr-1.
vec3 air_light_to(vec4 look, float share) {
    float slice = share * (AIR_SLICES - 1.0), low = min(floor(slice), AIR_SLICES - 2.0);
    float turned = abs(look.y - air_turn);
    float column = sqrt(2.0 * min(turned, 1.0 - turned)) * (AIR_AROUND - 1.0);
    vec2 size = vec2(AIR_AROUND * AIR_SLICES, AIR_ROWS);
    vec2 at = vec2(column + low * AIR_AROUND, look.x * (AIR_ROWS - 1.0)) + 0.5;
    vec3 near = textureLod(air_light, at / size, 0.0).rgb;
    vec3 far = textureLod(air_light, (at + vec2(AIR_AROUND, 0.0)) / size, 0.0).rgb;
    return mix(near, far, slice - low);
}
