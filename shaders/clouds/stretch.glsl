// The stretches of a ray inside the layer, as slabs: what no sun changes.
//
// Belcour 2009, section 4.2; formulas a8. A stretch is taken where the middle of a layer of mean thickness lies: thickness
// from the map there, apparent cosine from the slot `geometry`. What the camera or the ground cuts off makes the slab thinner,
// not its slant.

struct Stretch {
    float t;         // m along the ray, of its middle; 0 where there is none
    float depth;     // optical depth along the vertical
    float thickness; // m
    float mu_view;   // apparent cosine of the ray
    vec2 slope;      // of the upper side, rise over run to the east and to the north
};

// nominal: start and length of the stretch inside the thickest layer, m. end: where the ground ends the ray. footprint: width
// of the ray at one metre.
Stretch stretch_of(Path path, vec3 origin, vec3 direction, int leg, vec2 nominal, float end, float footprint) {
    // The thickest cloud is many times the mean one: the middle of the search is far from that of the cloud.
    vec2 middle = path_distances(path, layer_base + 0.5 * layer_thickness);
    float t = clamp(middle.x > middle.y ? -path.along : leg == 0 ? middle.x : middle.y, nominal.x, nominal.x + nominal.y);
    vec3 point = origin + t * direction;
    float cosine = dot(direction, up_at(point));
    // A quarter and four fifths of the layer's mean height: what lies below its half, and above it, is looked for there.
    float climb = sign(cosine) * layer_thickness / max(abs(cosine), 0.05);
    vec2 at = clamp(t + vec2(-0.25, 0.3) * climb, vec2(nominal.x), vec2(nominal.x + nominal.y));
    vec2 lower = place_of(origin + at.x * direction), upper = place_of(origin + at.y * direction);
    Cover cover = cover_through(lower, upper, footprint * t * inversesqrt(clamp(abs(cosine), 0.1, 1.0)));
    float thickness = max(cover.thickness, 1.0e-3);
    float within = geometry_leg(path, leg, layer_base, thickness, cosine, end);
    float whole = geometry_slant(abs(cosine), layer_base, thickness);
    float share = clamp(within / max(whole, 1.0e-6), 0.0, 1.0);
    float depth = layer_extinction * cover.thickness * share;
    float mu_view = clamp(thickness / max(whole, 1.0e-6), 1.0e-3, 1.0);
    return Stretch(nominal.y > 0.0 ? max(t, 1.0e-3) : 0.0, depth, thickness, mu_view, cover.slope);
}
