// The light of one stretch of a ray through the layer, and of the ground below it.
//
// Belcour 2009, chapters 4 and 5; formulas a3 to a8. A stretch is a slab: optical depth layer_extinction x thickness, the
// apparent cosines of sun and ray from the slot `geometry`, light from `scattering`, light from the ground from `bounce`.
// The sun may stand below the horizon of the layer and light its base, after it has crossed the layer far away (formulas a8).

struct Stretch {
    vec3 light; // W m-2 sr-1
    vec3 kept;  // share of what lies behind that comes through unscattered
};

// Irradiance of a plane that faces the sun at a point of the layer, W m-2; mu: the sun's zenith cosine there.
vec3 sun_at_layer(vec3 point, float altitude, float mu) {
    vec3 light = sun_irradiance * sun_through_air(altitude, mu);
    float far = -2.0 * (planet_radius + layer_base) * mu; // where a ray that dips below the layer meets it again
    Cover cover = cover_at(place_of(point + sun_direction * max(far, 0.0)), 4000.0);
    float slant = geometry_slant(abs(mu), layer_base, max(cover.thickness, 1.0e-3));
    float depth = layer_extinction * slant * min(cover.thickness, 1.0);
    return mu < 0.0 ? light * exp(-min(depth, AIR_DARKEST)) : light;
}

Stretch cloud_stretch(Path path, vec3 origin, vec3 direction, int leg, vec2 nominal, float end, float footprint) {
    float t = nominal.x + 0.5 * nominal.y;
    vec3 point = origin + t * direction;
    vec3 up = up_at(point);
    float cosine = dot(direction, up);
    Cover cover = cover_at(place_of(point), footprint * t / clamp(abs(cosine), 0.1, 1.0));
    float thickness = max(cover.thickness, 1.0e-3);
    float length_inside = geometry_leg(path, leg, layer_base, thickness, cosine, end);
    float whole = layer_extinction * cover.thickness;
    // What the camera or the ground cuts off makes the slab thinner, not its slant.
    float uncut = geometry_slant(abs(cosine), layer_base, thickness);
    float share = clamp(length_inside / max(uncut, 1.0e-6), 0.0, 1.0);
    float mu_view = clamp(thickness / max(uncut, 1.0e-6), 1.0e-3, 1.0);
    float depth = whole * share;
    float above = cosine < 0.0 ? 1.0 : 0.0; // the ray comes from above

    float mu = dot(up, sun_direction);
    vec3 tilted = normalize(up - layer_relief * vec3(cover.slope, 0.0));
    float leaning = mu > 0.0 ? max(dot(tilted, sun_direction), 0.02) : -mu;
    float mu_sun = clamp(thickness / geometry_slant(leaning, layer_base, thickness), 1.0e-3, 1.0);
    vec3 level_ray = direction - cosine * up, level_sun = -(sun_direction - mu * up);
    // The light runs along -sun_direction, and leaves along -direction.
    float cos_scatter = dot(direction, sun_direction);
    float cos_azimuth = dot(-level_ray, level_sun) / max(length(level_ray) * length(level_sun), 1.0e-6);
    Slab slab = Slab(depth, mu_sun, mu_view, cos_scatter, clamp(cos_azimuth, -1.0, 1.0));
    bool same_side = (mu > 0.0) == (above > 0.5);
    vec3 lit = sun_at_layer(point, layer_base + thickness, mu);
    vec3 light = lit * (same_side ? scattering_up(slab) : scattering_down(slab));

    vec3 reflected = scattering_diffuse_reflectance(depth);
    vec3 passed = max(1.0 - reflected - exp(-1.66 * depth), vec3(0.0));
    vec3 from_top = air_skylight_at(mu), from_base = bounce_cloud(place_of(point));
    light += (above > 0.5 ? reflected * from_top + passed * from_base : passed * from_top + reflected * from_base) / AIR_PI;
    vec3 kept = scattering_direct(depth, mu_view);
    bool there = length_inside > 0.0 && cover.thickness > 0.01;
    return Stretch(there ? light : vec3(0.0), there ? kept : vec3(1.0));
}

// What the ground sends to the eye, W m-2 sr-1. normal, albedo: of the land at the point.
vec3 ground_light(vec3 point, float altitude, vec3 normal, vec3 albedo) {
    float mu = dot(up_at(point), sun_direction);
    vec2 place = place_of(point);
    float facing = max(dot(normal, sun_direction), 0.0) * land_sees_sun(place, mu);
    Shade shade = cloud_shadow(point, altitude, mu);
    vec3 light = sun_irradiance * sun_through_air(altitude, mu) * (facing * shade.direct + max(mu, 0.0) * shade.diffuse);
    light += air_skylight_at(mu) * shade.sky + bounce_ground(place);
    return albedo / AIR_PI * light;
}
