// What the layer leaves of the sun and of the sky for a point of the ground.
struct Shade {
    vec3 direct;  // share of the beam
    vec3 diffuse; // share of the beam's flux on level ground that arrives scattered
    vec3 sky;     // share of the sky's light
};

// For the cover over or before a point; mu: apparent cosine of the sun in the layer.
Shade shade_under(Cover cover, float mu) {
    float depth = layer_extinction * cover.thickness;
    vec3 direct = scattering_direct(depth, mu);
    vec3 all = mix(vec3(1.0), scattering_transmittance(depth, mu), step(1.0e-3, depth));
    return Shade(direct, max(all - direct, vec3(0.0)), 1.0 - scattering_diffuse_reflectance(depth));
}
