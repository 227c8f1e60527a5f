// The shadow of what stands overhead, as a light map painted on the ground. Bouthors, Neyret and Lefebvre 2006.
//
// Symbols: mu the sun's zenith cosine at the point. Deviation: it is cast straight down, so it lies under its cloud even
// when the sun is low, layer_base / tan(elevation) away from where it belongs.

Shade cloud_shadow(vec3 point, float altitude, float mu) {
    Cover cover = cover_at(place_of(point), 1.0);
    float thickness = max(cover.thickness, 1.0e-3);
    return shade_under(cover, clamp(thickness / geometry_slant(max(mu, 0.0), layer_base, thickness), 1.0e-3, 1.0));
}
