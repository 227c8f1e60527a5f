// Where along a ray light is evaluated: at one random level of opacity, the inverse of its cumulative distribution.
// A ray's opacity is exact; the place where it passes the level xi stands for all the light of the ray, whose mean over rays is
// the sum of T (1 - e^(-sigma ds)) S (formulas g). One look at the light per ray costs least for the error of a converged picture.
// Symbols: place.xyz position [m], place.w normalised canopy height h, GROUND on the ground, NOTHING where xi is never reached;
// voxel what was read there (world.glsl). Handed on to the light, h grows by WOOD where the voxel is wood.

const float GROUND = -1.0;
const float NOTHING = -2.0;
const float WOOD = 2.0;

struct Event {
    vec4 place;
    vec4 voxel;
    float opacity;
    float xi;
};

Event no_event(float xi) {
    return Event(vec4(0.0, 0.0, 0.0, NOTHING), vec4(0.0), 0.0, xi);
}

// Raises the opacity to `opacity` at a place, which the event takes if its level is passed on the way.
void add_matter(inout Event event, vec4 place, vec4 voxel, float opacity) {
    bool passed = event.opacity <= event.xi && opacity > event.xi;
    event.place = passed ? place : event.place;
    event.voxel = passed ? voxel : event.voxel;
    event.opacity = opacity;
}

float filter_level(float footprint);

// Whole mip level for a point at distance t [m]: rounded at random, so that levels blend over rays without a second fetch.
float level_at(float t, float random) {
    return floor(filter_level(max(t, 0.0) * pixel_angle + pixel_width) + random);
}
