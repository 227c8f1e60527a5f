// Where along a ray light is evaluated: at LIGHT_EVENTS stratified levels of opacity, the inverse of its cumulative distribution.
// A ray's opacity is exact; each level tau_k = (k + xi) / LIGHT_EVENTS it passes stands for an equal share of the light.
// Symbols: place.xyz position [m], place.w normalised canopy height h, GROUND on the ground, NOTHING where the level is never reached;
// voxel what was read there (world.glsl).

const float GROUND = -1.0;
const float NOTHING = -2.0;

struct Events {
    vec4 place[LIGHT_EVENTS];
    vec4 voxel[LIGHT_EVENTS];
    float opacity;
    float xi;
};

Events no_events(float xi) {
    Events events;
    for (int k = 0; k < LIGHT_EVENTS; k++) {
        events.place[k] = vec4(0.0, 0.0, 0.0, NOTHING);
        events.voxel[k] = vec4(0.0);
    }
    events.opacity = 0.0;
    events.xi = xi;
    return events;
}

// Raises the opacity to `opacity` at a place, which serves every level passed on the way.
void add_event(inout Events events, vec4 place, vec4 voxel, float opacity) {
    for (int k = 0; k < LIGHT_EVENTS; k++) {
        float tau = (float(k) + events.xi) / float(LIGHT_EVENTS);
        bool passed = events.opacity <= tau && opacity > tau;
        events.place[k] = passed ? place : events.place[k];
        events.voxel[k] = passed ? voxel : events.voxel[k];
    }
    events.opacity = opacity;
}

float filter_level(float footprint);

// Whole mip level for a point at distance t [m]: rounded at random, so that levels blend over rays without a second fetch.
float level_at(float t, float random) {
    return floor(filter_level(max(t, 0.0) * pixel_angle + pixel_width) + random);
}
