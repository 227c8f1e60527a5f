// One ray of the picture: air, clouds, air, and ground or space, from the eye on.
//
// Belcour 2009, chapters 4 to 6; formulas a8. A ray from above that passes under the layer and leaves it again behind the
// horizon meets it twice: what it sends the second time stands behind all air.

// Air before and behind a cut of the ray: light (W m-2 sr-1) as each part's own beginning sees it, and what they let through.
struct Airs {
    vec3 light;
    vec3 kept;
    vec3 light_behind;
    vec3 kept_behind;
};

// stop: where the ground ends the ray, m.
Airs airs_along(Path path, vec3 origin, vec3 direction, float stop, float cut) {
    vec3 depth, depth_behind;
    Airs airs;
#if AIR_TABLE == 1
    // The table's ray ends at the sphere or at the air's top; the land's hills end it before.
    float sphere = sphere_distance(path);
    AirView view = air_view(direction, sphere < NEVER);
    AirRay ray = air_ray(path, sphere);
    vec3 near = air_to(view, air_share(ray, cut), depth), all = air_to(view, air_share(ray, stop), depth_behind);
    airs.light = near;
    airs.kept = exp(-depth);
    airs.light_behind = max(all - near, vec3(0.0)) * exp(depth);
    airs.kept_behind = exp(depth - depth_behind);
#else
    AirRay ray = air_ray(path, stop);
    float share = air_share(ray, cut);
    airs.light = air_between(path, ray, origin, direction, vec2(0.0, share), AIR_STEPS, depth);
    airs.kept = exp(-min(depth, AIR_DARKEST));
    airs.light_behind = air_between(path, ray, origin, direction, vec2(share, 1.0), AIR_STEPS, depth_behind);
    airs.kept_behind = exp(-min(depth_behind, AIR_DARKEST));
#endif
    return airs;
}

// Radiance of sun or ground behind everything else.
vec3 light_behind(vec3 origin, vec3 direction, Path path, vec4 ground, vec3 albedo, float overhead) {
    vec3 light = ground_light(origin + ground.x * direction, path_altitude(path, ground.x), ground.yzw, albedo, overhead);
#if BACKGROUND_SKY == 1
    float chord = 2.0 * sin(0.5 * SUN_RADIUS);
    vec3 disc = length(direction - sun_direction) < chord ? sun_irradiance / (AIR_PI * SUN_RADIUS * SUN_RADIUS) : vec3(0.0);
#else
    vec3 disc = vec3(0.0);
#endif
    return ground.x >= 0.0 ? light : disc;
}

// ground: distance (m), below 0 where there is none, and normal. overhead: thickness of the layer above it, m.
vec4 radiance_along(vec3 origin, vec3 direction, Path path, vec4 ground, vec3 albedo, float overhead, Stretch first, Stretch second) {
    float stop = ground.x >= 0.0 ? ground.x : NEVER;
    float cut = first.t > 0.0 ? first.t : CAMERA_SIDE < 0 ? stop : 0.0;
    Airs airs = airs_along(path, origin, direction, stop, cut);
    // The part of the air that lies under the layer takes its shade from one place.
    float under = CAMERA_SIDE < 0 ? min(0.5 * cut, 3.0e4) : cut + 0.5 * min(stop - cut, 6.0e4);
    vec3 shaded = origin + under * direction;
    float altitude = path_altitude(path, under), mu = dot(up_at(shaded), sun_direction);
#if TWILIGHT == 1
    float lit = air_lit(shaded, altitude, mu, sun_past_layer(shaded, altitude, mu));
#else
    float lit = air_lit(shaded, altitude, mu, 1.0);
#endif
#if CAMERA_SIDE < 0
    airs.light *= lit;
#else
    airs.light_behind *= lit;
#endif
    vec3 behind = light_behind(origin, direction, path, ground, albedo, overhead);
    Lit near = stretch_light(first, origin, direction, ground.x >= 0.0 ? albedo : planet_albedo);
#if CAMERA_SIDE >= 0
    Lit far = stretch_light_far(second, origin, direction);
    behind = far.light + far.kept * behind;
#else
    Lit far = Lit(vec3(0.0), vec3(1.0));
#endif
    vec3 kept = airs.kept * near.kept;
    vec3 light = airs.light + airs.kept * near.light + kept * (airs.light_behind + airs.kept_behind * behind);
#if BACKGROUND_SKY == 1
    return vec4(light, 1.0);
#else
    kept *= airs.kept_behind * far.kept;
    return vec4(light, ground.x >= 0.0 ? 1.0 : 1.0 - dot(kept, vec3(0.2126, 0.7152, 0.0722)));
#endif
}
