// The shadow from the layer's transmittance along the sun's ray. Belcour 2009, section 3.3.1.
//
// Symbols: rise, height of the layer's middle over the point (m); x = -r mu + sqrt((r mu)^2 + rise (2 r + rise)) the way to it
// on the sphere (formulas a8), r = planet_radius + altitude. Light that the layer scatters arrives from overhead.

Shade cloud_shadow(vec3 point, float altitude, float mu, float overhead) {
    float r = planet_radius + altitude;
    float rise = max(layer_base + 0.5 * layer_thickness - altitude, 0.0);
    float square = rise * (2.0 * r + rise), level = r * max(mu, 0.0);
    float way = square / max(level + sqrt(level * level + square), 1.0);
    vec3 met = point + way * sun_direction;
    float crossed = above_point(cover_at(place_of(met), shade_footprint(point)).thickness, altitude);
    return shade_under(above_point(overhead, altitude), crossed, shade_slant(dot(up_at(met), sun_direction), max(crossed, 1.0e-3)));
}
