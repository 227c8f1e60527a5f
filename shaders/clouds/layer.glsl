// The layer's thickness, and the shadow it casts on the air below.
//
// cloud_map      r: thickness as a share of the layer's, below 0 between clouds, so that edges do not follow the texels; gb: how it
//                grows east and north per metre; a: what of r is above 0, for means over more than a texel; the moment's
// cloud_systems  share of that which the weather systems leave, over the whole Earth round the site
// A footprint chooses the mip level: thickness is averaged before light is computed, so a distant broken layer is a thin one.

struct Cover {
    float thickness; // m
    vec2 slope;      // rise of the upper side over run, to the east and to the north
};

// The map alone: thickness as a share of the layer's, and how it grows to the east and to the north per metre; m from its middle.
vec3 map_at(vec2 from_middle, float footprint) {
    vec2 at = from_middle / cloud_side;
    float level = log2(max(footprint * float(textureSize(cloud_map, 0).x) / cloud_side, 1.0));
    vec4 found = textureLod(cloud_map, at + 0.5, level);
    float inside = cloud_repeats > 0.5 ? 1.0 : float(max(abs(at.x), abs(at.y)) < 0.5);
    return inside * vec3(mix(max(found.r, 0.0), found.a, min(level, 1.0)), found.gb);
}

// Share of the layer that the weather systems leave. half_place: m from the site over the planet's diameter.
float weather_at(vec2 half_place, float stretched, float footprint) {
    vec2 at = half_place * inversesqrt(stretched); // Lambert's projection of the whole sphere, -1 to 1
    float texel = 4.0 * planet_radius / float(textureSize(cloud_systems, 0).x);
    return textureLod(cloud_systems, 0.5 + 0.5 * at, log2(max(footprint / texel, 1.0))).r;
}

// place: m from the site. footprint: m, over which it is seen.
Cover cover_at(vec2 place, float footprint) {
    vec2 half_place = place / (2.0 * planet_radius);
    float stretched = 1.0 + dot(half_place, half_place); // of the stereographic projection
    vec3 found = map_at(place - cloud_drift, footprint * stretched);
    found *= layer_thickness * weather_at(half_place, stretched, footprint);
    return Cover(found.x, found.yz);
}

const float WIDER = 13.0;                       // how much wider the map is laid for what is far
const float WIDE_FROM = 0.007, WIDE_TO = 0.035; // footprints, of the map's side

const float MIDWAY = 0.5; // of the mean thickness: what of a cloud is higher is looked for at `upper`

// The same as the eye sees it along a ray, which is low in a layer of mean thickness at `place` and high at `upper`: where it finds a
// gap in one and cloud in the other, it goes through the cloud. footprint: the mean of the width and the length of the ray's, or gaps
// would close that are wide enough to be seen. From so far that the map's period would show, clouds are those of the map laid wider
// and turned.
Cover cover_through(vec2 place, vec2 upper, float footprint) {
    vec2 half_place = place / (2.0 * planet_radius), from_middle = place - cloud_drift;
    float stretched = 1.0 + dot(half_place, half_place);
    float across = footprint * stretched;
    vec3 found = map_at(from_middle, across);
    found.x = min(found.x, MIDWAY) + max(map_at(upper - cloud_drift, across).x - MIDWAY, 0.0);
    vec2 turned = vec2(0.8 * from_middle.x - 0.6 * from_middle.y, 0.6 * from_middle.x + 0.8 * from_middle.y);
    float wide = cloud_widens * smoothstep(WIDE_FROM, WIDE_TO, footprint / cloud_side);
    // Farther still its period would show too: its mean is left, and the weather.
    float seen = across / WIDER, even = exp2(6.0 * smoothstep(WIDE_FROM, WIDE_TO, seen / cloud_side));
    found = mix(found, vec3(map_at(turned / WIDER, seen * even).x, 0.0, 0.0), wide);
    found *= layer_thickness * weather_at(half_place, stretched, footprint);
    return Cover(found.x, found.yz);
}

float slab_diffuse_share(float optical_depth) {
    return 1.0 / (1.0 + 0.11 * optical_depth);
}

// Share of the light that the layer leaves to the air at a point below it: Eddington's, for even light and g = 0.85.
// mu: the sun's zenith cosine there. past: share of a low sun's beam that comes past the layer, from below it or through its gaps.
float air_lit(vec3 point, float altitude, float mu, float past) {
    float rise = layer_base + 0.5 * layer_thickness - altitude;
    float slant = rise / max(mu, 0.05);
    Cover cover = cover_at(place_of(point + sun_direction * slant), 2000.0);
    float share = slab_diffuse_share(layer_extinction * cover.thickness / max(mu, 0.2) * 0.5);
    return rise > 0.0 ? mix(past, share, clamp(10.0 * mu + 0.5, 0.0, 1.0)) : 1.0;
}
