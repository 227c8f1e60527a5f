// No height shading: the identity of the slot. Deviations: none. It claims nothing.

float height_factor(float h) {
    return 1.0;
}
