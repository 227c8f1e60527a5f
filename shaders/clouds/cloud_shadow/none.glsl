// No shadow of the clouds: sun and sky reach the ground as if there were none. Belcour 2009, section 3.3.1 starts from here.

Shade cloud_shadow(vec3 point, float altitude, float mu, float overhead) {
    return Shade(vec3(1.0), vec3(0.0), vec3(1.0));
}
