// Empirical height shading. Cohen 2004, section 3.2: C(h) = 0.5 + h.
// Symbols: h normalised canopy height [-], foot = C(0), rise = C(1) - C(0), strength blends to 1.
// Does not know the sun, nor the tree: it stands for the darkness of the lower canopy only.

// Section 3.2, "C(h) = 0.5 + h".
float height_factor(float h) {
    return mix(1.0, height_shading_foot + height_shading_rise * h, height_shading_strength);
}
