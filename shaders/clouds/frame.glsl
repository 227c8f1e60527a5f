// One ray of the picture: air, clouds, air, and ground or space, from the eye on; in parts that are drawn where they are seen.
//
// Belcour 2009, chapters 4 to 6; formulas a8. A ray from above that passes under the layer and leaves it again behind the
// horizon meets it twice: what it sends the second time stands behind all air.
// What no sun changes of a ray is traced before (FRAME_TRACED). What is left is a sum, light that the air sends + light of
// the layer x what the air before it keeps + light behind both x what all of it keeps, so each part adds itself to the picture.
// Deviation: what stands behind less than HIDDEN of a cloud is not drawn; the layer met again is left out behind ground.

// What a ray shows, in an order in which every part is drawn over one or two neighbours (renderer/clouds/frame_passes.py has
// them too).
const float SHOWS_SKY = 1.0, SHOWS_GROUND = 2.0, SHOWS_FAR = 3.0, SHOWS_FAR_THROUGH = 4.0;
const float SHOWS_GROUND_THROUGH = 5.0, SHOWS_SKY_THROUGH = 6.0, SHOWS_CLOUD = 7.0, SHOWS_ALL = 16.0;
const float HIDDEN = 1.0e-4;

// What a ray shows of a layer that keeps some of what stands behind it, of the layer met again, and of ground.
float shown_by(bool cloud, float kept, bool again, bool ground) {
    if (cloud && kept < HIDDEN) return SHOWS_CLOUD;
    if (ground) return cloud ? SHOWS_GROUND_THROUGH : SHOWS_GROUND;
    if (again) return cloud ? SHOWS_FAR_THROUGH : SHOWS_FAR;
    return cloud ? SHOWS_SKY_THROUGH : SHOWS_SKY;
}

// Share of a beam along a ray that a stretch leaves unscattered; 1 means that no cloud is there, and of the least cloud half
// floats still tell it apart.
float stretch_keeps(Stretch s) {
    return s.t > 0.0 && s.depth > 1.0e-6 ? exp(-clamp(s.depth / s.mu_view, 5.0e-4, AIR_DARKEST)) : 1.0;
}

// What is known of all rays of a picture before it is drawn: whether all that the air before the layer sends lies under it, where
// the layer takes the sun away, and is drawn with the air, or over it, and is drawn with the layer.
#if CAMERA_SIDE < 0
const bool AIR_UNDER = true;
#else
const bool AIR_UNDER = false;
#endif

#ifdef FRAME_TRACED
// The same for each sun: where the ray reads the air's table, to the layer and to its end; what the air before the layer keeps,
// and what the ray shows; what all air and the layer keep.
struct Look {
    vec4 air; // row and azimuth of the table, shares of the way to the layer and to the end
    vec3 kept;
    vec3 past;
};

// stop: where the ground ends the ray, m. cut: where it meets the layer. near_kept: share that the layer leaves.
Look look_along(Path path, vec3 origin, vec3 direction, float stop, float cut, float near_kept) {
    Look look;
    vec3 depth, depth_behind;
#if AIR_TABLE == 1
    // The table's ray ends at the sphere or at the air's top; the land's hills end it before.
    float sphere = sphere_distance(path);
    AirRay ray = air_ray(path, sphere);
    look.air = vec4(air_place(direction, sphere < NEVER), air_share(ray, cut), air_share(ray, stop));
    depth = air_depth_to(look.air, look.air.z);
    depth_behind = air_depth_to(look.air, look.air.w);
#else
    AirRay ray = air_ray(path, stop);
    look.air = vec4(0.0, 0.0, air_share(ray, cut), 1.0);
    air_between(path, ray, origin, direction, vec2(0.0, look.air.z), AIR_STEPS, depth);
    air_between(path, ray, origin, direction, vec2(look.air.z, 1.0), AIR_STEPS, depth_behind);
    depth_behind += depth;
#endif
    look.kept = exp(-min(depth, AIR_DARKEST));
    look.past = near_kept * exp(-min(depth_behind, AIR_DARKEST));
    return look;
}
#endif

#ifdef FRAME_LIT
struct Ray {
    vec3 origin;
    vec3 direction;
    Path path;
    ivec2 pixel;
};

Stretch traced_near(Ray ray) {
    vec4 near = texelFetch(traced_first, ray.pixel, 0);
    return Stretch(near.x, near.y, near.z, near.w, texelFetch(traced_slopes, ray.pixel, 0).xy);
}

// Light that the air before the layer sends and that behind it, as the eye sees them with no cloud there, W m-2 sr-1.
void air_of(Ray ray, out vec3 near, out vec3 behind) {
    vec4 look = texelFetch(traced_look, ray.pixel, 0);
#if AIR_TABLE == 1
    // Rays that meet no cloud have one part: the second turn is skipped where none of their neighbours has two.
    vec3 all = vec3(0.0);
    int turn = 0;
    do {
        vec3 light = air_light_to(look, turn == 0 ? look.w : look.z);
        if (turn == 0) all = light; else near = light;
        turn++;
    } while (turn == 1 && look.z > 0.0 && look.z < look.w);
    if (turn == 1) near = look.z > 0.0 ? all : vec3(0.0);
    behind = max(all - near, vec3(0.0));
#else
    vec3 depth, kept = texelFetch(traced_kept, ray.pixel, 0).rgb;
    float distance_met = texelFetch(traced_ground, ray.pixel, 0).x;
    AirRay air = air_ray(ray.path, distance_met >= 0.0 ? distance_met : NEVER);
    near = air_between(ray.path, air, ray.origin, ray.direction, vec2(0.0, look.z), AIR_STEPS, depth);
    behind = kept * air_between(ray.path, air, ray.origin, ray.direction, vec2(look.z, 1.0), AIR_STEPS, depth);
#endif
}

// Of the sun's disc or nothing behind all, how much is hidden.
float opaque(Ray ray, vec4 slopes) {
#if BACKGROUND_SKY == 1
    return 1.0;
#else
    vec3 left = texelFetch(traced_past, ray.pixel, 0).rgb * slopes.w;
    return texelFetch(traced_ground, ray.pixel, 0).x >= 0.0 ? 1.0 : 1.0 - dot(left, vec3(0.2126, 0.7152, 0.0722));
#endif
}

// Of the air: before and behind the layer where the camera is below it, behind it alone otherwise. What of it lies under the layer
// takes its shade from one place. The last component is what the picture's alpha grows by.
vec4 air_part(Ray ray) {
    vec4 slopes = texelFetch(traced_slopes, ray.pixel, 0);
    float under = texelFetch(traced_second, ray.pixel, 0).w;
    vec3 point = ray.origin + under * ray.direction, near, behind;
    float altitude = path_altitude(ray.path, under), mu = dot(up_at(point), sun_direction);
#if TWILIGHT == 1
    float lit = air_lit(point, altitude, mu, sun_past_layer(point, altitude, mu));
#else
    float lit = air_lit(point, altitude, mu, 1.0);
#endif
    air_of(ray, near, behind);
    float over = slopes.z < 1.0 ? 0.0 : 1.0; // with no cloud there, both are drawn here
    vec3 light = AIR_UNDER ? lit * near + slopes.z * behind : slopes.z * lit * behind + over * near;
    return vec4(light, opaque(ray, slopes));
}

// Of the layer, and of the air before it where the camera is not below it.
vec4 cloud_part(Ray ray) {
    vec4 albedo = texelFetch(traced_albedo, ray.pixel, 0), kept = texelFetch(traced_kept, ray.pixel, 0);
    vec3 light = kept.rgb * stretch_light(traced_near(ray), ray.origin, ray.direction, albedo.rgb);
    if (AIR_UNDER) return vec4(light, 0.0);
    vec4 look = texelFetch(traced_look, ray.pixel, 0);
#if AIR_TABLE == 1
    light += air_light_to(look, look.z);
#else
    vec3 near, behind;
    air_of(ray, near, behind);
    light += near;
#endif
    return vec4(light, kept.a == SHOWS_CLOUD ? 1.0 : 0.0);
}

// Of the ground.
vec4 ground_part(Ray ray) {
    vec4 ground = texelFetch(traced_ground, ray.pixel, 0), past = texelFetch(traced_past, ray.pixel, 0);
    vec4 albedo = texelFetch(traced_albedo, ray.pixel, 0);
    vec3 point = ray.origin + ground.x * ray.direction;
    return vec4(past.rgb * ground_light(point, path_altitude(ray.path, ground.x), ground.yzw, albedo.rgb, past.a), 0.0);
}

// Of the layer where the ray leaves it again behind the horizon.
vec4 far_part(Ray ray) {
    vec4 far = texelFetch(traced_second, ray.pixel, 0), past = texelFetch(traced_past, ray.pixel, 0);
    return vec4(past.rgb * stretch_light_far(Stretch(far.x, far.y, 1.0, far.z, vec2(0.0)), ray.origin, ray.direction), 0.0);
}

// Of the sun's disc.
vec4 disc_part(Ray ray) {
    vec3 left = texelFetch(traced_past, ray.pixel, 0).rgb * texelFetch(traced_slopes, ray.pixel, 0).w;
    bool before = texelFetch(traced_ground, ray.pixel, 0).x < 0.0;
    bool on = before && length(ray.direction - sun_direction) < 2.0 * sin(0.5 * SUN_RADIUS);
    return vec4(on ? left * sun_irradiance / (AIR_PI * SUN_RADIUS * SUN_RADIUS) : vec3(0.0), 0.0);
}
#endif
