// Reading of the tables of air_table.glsl.

struct AirView {
    vec2 place; // column inside a slice and row, texels from 0
};

AirView air_view(vec3 direction, bool ground) {
    float cosine = dot(direction, air_up);
    vec3 level = direction - cosine * air_up;
    float zenith = atan(length(level), cosine);
    float rows = 0.5 * AIR_ROWS;
    float x = ground ? (zenith - air_horizon) / (AIR_PI - air_horizon) : (air_horizon - zenith) / (air_horizon - air_limb);
    float row = sqrt(clamp(x, 0.0, 1.0)) * (rows - 1.0) + (ground ? rows : 0.0);
    float azimuth = acos(clamp(dot(level, air_ahead) / max(length(level), 1.0e-20), -1.0, 1.0));
    return AirView(vec2(sqrt(azimuth / AIR_PI) * (AIR_AROUND - 1.0), row));
}

// Light of the air from the eye to a share of the ray, W m-2 sr-1, and its optical depth.
vec3 air_to(AirView view, float share, out vec3 depth) {
    float slice = share * (AIR_SLICES - 1.0);
    vec2 size = vec2(AIR_AROUND * AIR_SLICES, AIR_ROWS);
    depth = textureLod(air_passed, (vec2(slice, view.place.y) + 0.5) / vec2(AIR_SLICES, AIR_ROWS), 0.0).rgb;
    float low = min(floor(slice), AIR_SLICES - 2.0);
    vec2 at = view.place + 0.5;
    vec3 near = textureLod(air_light, (at + vec2(low * AIR_AROUND, 0.0)) / size, 0.0).rgb;
    vec3 far = textureLod(air_light, (at + vec2((low + 1.0) * AIR_AROUND, 0.0)) / size, 0.0).rgb;
    return mix(near, far, slice - low);
}
