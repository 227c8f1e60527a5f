// The shadow of what stands overhead, as a light map painted on the ground. Bouthors, Neyret and Lefebvre 2006.
//
// Symbols: mu the sun's zenith cosine at the point; overhead the layer's thickness there (m).
// Deviation: it is cast straight down, so it lies under its cloud even when the sun is low, layer_base / tan(elevation) away
// from where it belongs.

Shade cloud_shadow(vec3 point, float altitude, float mu, float overhead) {
    float above = above_point(overhead, altitude);
    return shade_under(above, above, shade_slant(mu, max(above, 1.0e-3)));
}
