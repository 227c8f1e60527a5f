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

// place: m from the site. footprint: m, over which it is seen.
Cover cover_at(vec2 place, float footprint) {
    vec2 at = (place - cloud_drift) / cloud_side;
    float texel = cloud_side / float(textureSize(cloud_map, 0).x);
    vec2 half_place = place / (2.0 * planet_radius);
    float stretched = 1.0 + dot(half_place, half_place); // of the stereographic projection
    float level = log2(max(footprint * stretched / texel, 1.0));
    vec4 found = textureLod(cloud_map, at + 0.5, level);
    float share = mix(max(found.r, 0.0), found.a, min(level, 1.0));
    float inside = cloud_repeats > 0.5 ? 1.0 : float(max(abs(at.x), abs(at.y)) < 0.5);
    float wide = 4.0 * planet_radius / float(textureSize(cloud_systems, 0).x);
    vec2 weather = half_place * inversesqrt(stretched); // Lambert's projection of the whole sphere, -1 to 1
    float systems = textureLod(cloud_systems, 0.5 + 0.5 * weather, log2(max(footprint / wide, 1.0))).r;
    return Cover(layer_thickness * inside * systems * share, layer_thickness * inside * systems * found.gb);
}

float slab_diffuse_share(float optical_depth) {
    return 1.0 / (1.0 + 0.11 * optical_depth);
}

// Share of the light that the layer leaves to the air at a point below it: Eddington's, for even light and g = 0.85.
// mu: the sun's zenith cosine there. A point that the sun reaches from below the layer keeps it all.
float air_lit(vec3 point, float altitude, float mu) {
    float rise = layer_base + 0.5 * layer_thickness - altitude;
    float slant = rise / max(mu, 0.05);
    Cover cover = cover_at(place_of(point + sun_direction * slant), 2000.0);
    float share = slab_diffuse_share(layer_extinction * cover.thickness / max(mu, 0.2) * 0.5);
    return rise > 0.0 ? mix(1.0, share, clamp(10.0 * mu + 0.5, 0.0, 1.0)) : 1.0;
}
