// The light of one stretch of a ray through the layer, and of the ground below it.
//
// Belcour 2009, chapters 4 and 5; formulas a3 to a8. Light within a slab is the slot `scattering`'s, light that the ground
// sends up is the slot `bounce`'s.
// The sun may stand below the horizon of the layer and light its base, after it has crossed the layer far away (formulas a8).

const float SWELL_SHADE = 0.07;
const float GAPS = 8.0; // optical depth of a closed layer to a grazing sun: gaps let some light through a broken one

// Share of a low sun's beam that the layer leaves to a point at its base or under it: the ray leaves the layer where it meets it
// again, far away. mu: the sun's zenith cosine at the point.
float sun_past_layer(vec3 point, float altitude, float mu) {
    float r = planet_radius + altitude, rise = max(layer_base - altitude, 0.0);
    float along = r * mu, square = rise * (2.0 * r + rise), root = sqrt(along * along + square);
    float way = mu > 0.0 ? square / max(along + root, 1.0) : root - along;
    Cover cover = cover_at(place_of(point + sun_direction * way), 4.0e4); // a grazing ray is that long in the layer
    float slant = geometry_slant((along + way) / (planet_radius + layer_base), layer_base, max(layer_thickness, 1.0e-3));
    return exp(-min(layer_extinction * slant, GAPS) * cover.thickness / max(layer_thickness, 1.0e-3));
}

// Irradiance of a plane that faces the sun at a point of the layer, W m-2; mu: the sun's zenith cosine there.
vec3 sun_at_layer(vec3 point, float altitude, float mu) {
    vec3 light = sun_irradiance * sun_through_air(altitude, mu);
#if TWILIGHT == 1
    light *= mu < 0.0 ? sun_past_layer(point, layer_base, mu) : 1.0;
#endif
    return light;
}

// What is known of all rays of a picture before it is drawn: whether the layer's sunlit side is the one seen.
#if TWILIGHT == 0 && CAMERA_SIDE < 0
bool sunlit_side(float mu, bool from_above) { return false; }
#elif TWILIGHT == 0 && CAMERA_SIDE > 0
bool sunlit_side(float mu, bool from_above) { return true; }
#else
bool sunlit_side(float mu, bool from_above) { return (mu > 0.0) == from_above; }
#endif

// W m-2 sr-1. albedo: of the ground behind.
vec3 stretch_light(Stretch s, vec3 origin, vec3 direction, vec3 albedo) {
    vec3 point = origin + s.t * direction;
    vec3 up = up_at(point);
    float cosine = dot(direction, up), mu = dot(up, sun_direction);
    bool from_above = cosine < 0.0;
    vec3 tilted = normalize(up - layer_relief * vec3(s.slope, 0.0));
    // Light leaks round a swell, so that none is black and no shadow has an edge: SWELL_SHADE is what reaches a steep one end-on.
    // A level layer has no swells, and a low sun no more than its cosine.
    float facing = dot(tilted, sun_direction), leak = min(SWELL_SHADE, layer_relief * length(s.slope));
    float leaning = mu > 0.0 ? 0.5 * (facing + sqrt(facing * facing + 4.0 * leak * leak)) : -mu;
    float mu_sun = clamp(s.thickness / geometry_slant(leaning, layer_base, s.thickness), 1.0e-3, 1.0);
    vec3 level_ray = direction - cosine * up, level_sun = sun_direction - mu * up;
    // Light comes along -sun_direction and leaves along -direction.
    float turned = dot(level_ray, level_sun) * inversesqrt(max(dot(level_ray, level_ray) * dot(level_sun, level_sun), 1.0e-12));
    Slab slab = Slab(s.depth, mu_sun, s.mu_view, dot(direction, sun_direction), clamp(turned, -1.0, 1.0));
    vec3 beam = sun_at_layer(point, layer_base + s.thickness, mu) * layer_sees_sun(place_of(point), s.thickness, mu);
    vec3 light = beam * scattering_leaving(slab, sunlit_side(mu, from_above));

    vec3 reflected = scattering_diffuse_reflectance(s.depth);
    vec3 passed = max(1.0 - reflected - exp(-1.66 * s.depth), vec3(0.0));
    vec3 from_top = air_skylight_at(mu);
    // Where no map of the bounced light reaches: what comes through the layer here falls on the ground that is seen here.
    vec3 below = (beam * max(mu, 0.0) + from_top) * (1.0 - reflected);
    vec3 from_base = bounce_cloud(place_of(point), BounceHere(below, albedo, reflected));
    light += (from_above ? reflected * from_top + passed * from_base : passed * from_top + reflected * from_base) / AIR_PI;
    return light;
}

// The same where a ray from above leaves the layer again, hundreds of kilometres behind the horizon: what comes through a layer
// seen from below, alike in all directions.
vec3 stretch_light_far(Stretch s, vec3 origin, vec3 direction) {
    float altitude = layer_base, mu = dot(up_at(origin + s.t * direction), sun_direction);
    vec3 beam = sun_irradiance * sun_through_air(altitude, mu) * max(mu, 0.0) + air_skylight_at(mu);
    vec3 direct = scattering_direct(s.depth, s.mu_view);
    return beam * max(1.0 - scattering_diffuse_reflectance(s.depth) - direct, vec3(0.0)) / AIR_PI;
}

// What the ground sends to the eye, W m-2 sr-1. normal, albedo: of the land at the point. overhead: the layer's thickness, m.
vec3 ground_light(vec3 point, float altitude, vec3 normal, vec3 albedo, float overhead) {
    float mu = dot(up_at(point), sun_direction);
    vec2 place = place_of(point);
    vec2 seen = land_sees(place, mu);
    float facing = max(dot(normal, sun_direction), 0.0) * seen.x;
    vec3 open = seen.y / (1.0 - albedo * (1.0 - seen.y)); // the land across throws its share back, again and again
    Shade shade = cloud_shadow(point, altitude, mu, overhead);
    vec3 light = sun_irradiance * sun_through_air(altitude, mu) * (facing * shade.direct + max(mu, 0.0) * open * shade.diffuse);
    light += air_skylight_at(mu) * open * shade.sky;
    float under = clamp((layer_base + layer_thickness - altitude) / max(layer_thickness, 1.0), 0.0, 1.0); // summits are not
    light += under * open * bounce_ground(place, BounceHere(light, albedo, 1.0 - shade.sky));
    return albedo / AIR_PI * light;
}
