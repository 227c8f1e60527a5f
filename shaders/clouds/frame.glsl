// One ray of the picture: air, clouds, air, clouds, air, and ground or space, from the eye on.
//
// Belcour 2009, chapters 4 to 6; formulas a8.

struct Airs {
    vec3 light[3]; // of the three stretches of air, each as its own beginning sees it
    vec3 kept[3];
};

// The air of a ray, cut at two distances.
Airs airs_along(Path path, vec3 origin, vec3 direction, bool ground, float stop, vec2 cuts) {
    Airs airs;
#if AIR_TABLE == 1
    // The table's ray ends at the sphere or at the air's top; the land's hills end it before.
    float sphere = sphere_distance(path);
    AirView view = air_view(direction, sphere < NEVER);
    AirRay ray = air_ray(path, sphere);
    vec3 depths[3];
    vec3 lights[3];
    lights[0] = air_to(view, air_share(ray, cuts.x), depths[0]);
    lights[1] = air_to(view, air_share(ray, cuts.y), depths[1]);
    lights[2] = air_to(view, air_share(ray, min(stop, ray.end)), depths[2]);
    airs.light[0] = lights[0];
    airs.kept[0] = exp(-depths[0]);
    airs.light[1] = max(lights[1] - lights[0], vec3(0.0)) * exp(depths[0]);
    airs.kept[1] = exp(depths[0] - depths[1]);
    airs.light[2] = max(lights[2] - lights[1], vec3(0.0)) * exp(depths[1]);
    airs.kept[2] = exp(depths[1] - depths[2]);
#else
    AirRay ray = air_ray(path, stop);
    vec4 shares = vec4(0.0, air_share(ray, cuts.x), air_share(ray, cuts.y), 1.0);
    for (int n = 0; n < 3; n++) {
        vec3 depth;
        airs.light[n] = air_between(path, ray, origin, direction, vec2(shares[n], shares[n + 1]), AIR_STEPS, depth);
        airs.kept[n] = exp(-min(depth, AIR_DARKEST));
    }
#endif
    return airs;
}

// traced: distance to the ground (m), below 0 where there is none, and its normal. albedo: of it.
vec4 radiance_along(vec3 origin, vec3 direction, vec4 traced, vec3 albedo, float footprint) {
    Path path = path_of(origin, direction);
    bool ground = traced.x >= 0.0;
    float stop = ground ? traced.x : NEVER;
    vec4 legs = layer_legs(path, layer_base, layer_base + max(layer_thickness * layer_highest, 1.0), stop);
    // Nearly every ray has one stretch, and what only few have is skipped where none of its neighbours has it either.
    Stretch first = Stretch(vec3(0.0), vec3(1.0)), second = first;
    int leg = legs.y > 0.0 ? 0 : 1;
    do {
        vec2 nominal = leg == 0 ? legs.xy : legs.zw;
        Stretch found = cloud_stretch(path, origin, direction, leg, nominal, stop, footprint);
        if (leg == 0) first = found; else second = found;
        leg++;
    } while (leg == 1 && legs.w > 0.0);
    // A stretch stands at its middle; one that is not there, where the ray begins or ends.
    vec2 cuts = vec2(legs.y > 0.0 ? legs.x + 0.5 * legs.y : 0.0, legs.w > 0.0 ? legs.z + 0.5 * legs.w : stop);
    Airs airs = airs_along(path, origin, direction, ground, stop, cuts);
    // Between the two stretches the ray is under the layer, whose shade it takes from one place.
    float under = 0.5 * (cuts.x + min(cuts.y, cuts.x + 6.0e4));
    float low = path_altitude(path, under);
    vec3 beneath = origin + under * direction;
    airs.light[1] *= air_lit(beneath, low, dot(up_at(beneath), sun_direction));
    vec3 behind = vec3(0.0);
    if (ground) {
        behind = ground_light(origin + traced.x * direction, path_altitude(path, traced.x), traced.yzw, albedo);
    } else {
#if BACKGROUND_SKY == 1
        float chord = 2.0 * sin(0.5 * SUN_RADIUS);
        behind = length(direction - sun_direction) < chord ? sun_irradiance / (AIR_PI * SUN_RADIUS * SUN_RADIUS) : vec3(0.0);
#endif
    }
    vec3 kept = airs.kept[0] * first.kept;
    vec3 light = airs.light[0] + airs.kept[0] * first.light;
    light += kept * (airs.light[1] + airs.kept[1] * second.light);
    kept *= airs.kept[1] * second.kept;
    light += kept * airs.light[2];
    kept *= airs.kept[2];
    light += kept * behind;
#if BACKGROUND_SKY == 1
    return vec4(light, 1.0);
#else
    return vec4(light, ground ? 1.0 : 1.0 - dot(kept, vec3(0.2126, 0.7152, 0.0722)));
#endif
}
