// What the layer leaves of the sun and of the sky for a point of the ground.
struct Shade {
    vec3 direct;  // share of the beam
    vec3 diffuse; // share of the beam's flux on level ground that arrives scattered
    vec3 sky;     // share of the sky's light
};

// Width of a pixel at a point, m, over which a shadow is seen.
float shade_footprint(vec3 point) {
    return max(pixel_angle * distance(point, camera_origin), 1.0);
}

// What of a layer that thick (m) stands above an altitude (m): summits rise into it and through it.
float above_point(float thickness, float altitude) {
    return clamp(layer_base + thickness - altitude, 0.0, thickness);
}

// Apparent cosine in a layer so thick of a sun with zenith cosine mu at its base.
float shade_slant(float mu, float thickness) {
    return clamp(thickness / geometry_slant(max(mu, 0.0), layer_base, thickness), 1.0e-3, 1.0);
}

// Scattered light comes from the layer overhead, the beam from where the sun's ray crosses it; thicknesses in m, mu apparent.
Shade shade_under(float overhead, float crossed, float mu) {
    float above = layer_extinction * overhead, before = layer_extinction * crossed;
    vec3 all = above > 1.0e-3 ? scattering_transmittance(above, mu) : vec3(1.0);
    vec3 sky = above > 1.0e-3 ? 1.0 - scattering_diffuse_reflectance(above) : vec3(1.0);
    return Shade(scattering_direct(before, mu), max(all - scattering_direct(above, mu), vec3(0.0)), sky);
}
