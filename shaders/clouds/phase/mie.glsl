// Mie's phase function of water droplets. Mie 1908, "Beitraege zur Optik trueber Medien"; Belcour 2009, sections 2.3.2 and 3.1.
// Symbols: cosine of the angle between propagation directions [-] (1 = straight on); P [1/sr], integral over the sphere 1.
// Deviations: read from a table whose steps shrink towards both ends, as the fourth root of 1 - |cosine|.
// Does not know: polarisation; droplets that are not round.

#include "clouds/angles.glsl"

const float PHASE_ENTRIES = 2048.0;

// Row 0 of the table is P, row 1 is P convolved with itself.
vec3 phase_tabulated(float cosine, float row) {
    float column = (angle_place(cosine) * (PHASE_ENTRIES - 1.0) + 0.5) / PHASE_ENTRIES;
    return textureLod(phase_table, vec2(column, 0.25 + 0.5 * row), 0.0).rgb;
}

vec3 phase_value(float cosine) {
    return phase_tabulated(cosine, 0.0);
}

vec3 phase_twice(float cosine) {
    return phase_tabulated(cosine, 1.0);
}
