// A plane layer of cloud: what all its scattering techniques share. After Blinn 1982; formulas a3, a4.
// Symbols: tau optical_depth along the normal [-]; mu_l mu_sun, mu_v mu_view, cosines to the normal [-], positive; Theta the angle
// between the directions in which light comes and leaves, cosine [-]; phi their azimuth, cos_azimuth [-] (1 = straight on).
// Radiances are for each unit of irradiance on a plane that faces the sun [1/sr]; without the phase function, [-].

struct Slab {
    float optical_depth;
    float mu_sun;
    float mu_view;
    float cosine;
    float cos_azimuth;
};

const float SLAB_GRAZING = 1e-3;     // least cosine: below it a path would have no end
const float SLAB_DEEPEST = 80.0;     // exponent beyond which nothing is left in float32
const float SLAB_FOUR_PI = 12.566370614359172;

// Axes of tables over depth and cosines: two entries for each doubling of the depth, even steps of a cosine's root.
const float SLAB_LEAST = -6.0;
const float SLAB_DEPTHS = 29.0;
const float SLAB_COSINES = 20.0;

Slab slab_safe(Slab s) {
    return Slab(max(s.optical_depth, 0.0), max(s.mu_sun, SLAB_GRAZING), max(s.mu_view, SLAB_GRAZING), s.cosine, s.cos_azimuth);
}

// (1 - e^-x) / x, the mean of e^(-x s) over s from 0 to 1.
vec3 slab_mean_decay(vec3 x) {
    vec3 few = min(x, vec3(0.01));
    return mix((1.0 - exp(-x)) / max(x, vec3(0.01)), 1.0 - few * 0.5 * (1.0 - few * (1.0 / 3.0)), vec3(lessThan(x, vec3(0.01))));
}

// (1 - (1 + x) e^-x) / x^2, the integral of s e^(-x s) over s from 0 to 1.
float slab_ramped_decay(float x) {
    float few = min(x, 0.1);
    float series = 0.5 - few * (1.0 / 3.0 - few * (0.125 - few * (1.0 / 30.0)));
    return x < 0.1 ? series : (1.0 - (1.0 + x) * exp(-x)) / (x * x);
}

// Share of a beam that passes unscattered.
float slab_direct(float tau, float mu) {
    return exp(-min(tau / max(mu, SLAB_GRAZING), SLAB_DEEPEST));
}

// Order 1 of a layer of `kept` times the depth, over `kept`, on the sunlit side (up) or on the other: y (1 - e^-(x + y)) / (x + y), and
// y (e^-x - e^-y) / (y - x) written from the shorter path, so that no exponential grows; x, y the paths of sun and view.
vec3 slab_first(Slab s, vec3 kept, bool up) {
    float x = s.optical_depth / s.mu_sun;
    float y = s.optical_depth / s.mu_view;
    vec3 through = exp(-min(kept * (up ? 0.0 : min(x, y)), vec3(SLAB_DEEPEST)));
    return y * through * slab_mean_decay(kept * (up ? x + y : abs(x - y)));
}

vec3 slab_first_up(Slab s, vec3 kept) {
    return kept * slab_first(s, kept, true);
}

// Order 2 on the sunlit side.
float slab_second_up(Slab s) {
    float a = s.optical_depth * (1.0 / s.mu_sun + 1.0 / s.mu_view);
    return 0.5 * a * a * slab_ramped_decay(min(a, SLAB_DEEPEST)) * min(1.0, SLAB_DEEPEST * SLAB_DEEPEST / (a * a))
        * s.mu_sun / (s.mu_sun + s.mu_view);
}

vec3 slab_first_down(Slab s, vec3 kept) {
    return kept * slab_first(s, kept, false);
}

// Order 2 on the other side.
float slab_second_down(Slab s) {
    float x = s.optical_depth / s.mu_sun;
    float y = s.optical_depth / s.mu_view;
    float apart = abs(x - y);
    float through = min(x, y) * slab_mean_decay(vec3(apart)).x + apart * slab_ramped_decay(apart);
    return 0.5 * y * exp(-min(min(x, y), SLAB_DEEPEST)) * through;
}

// Place in a table over depth and a cosine, for textures whose rows are depths.
vec2 slab_place(float tau, float mu) {
    float row = clamp((log2(max(tau, 1e-6)) - SLAB_LEAST) * 2.0, 0.0, SLAB_DEPTHS - 1.0);
    return vec2((sqrt(clamp(mu, 0.0, 1.0)) * (SLAB_COSINES - 1.0) + 0.5) / SLAB_COSINES, (row + 0.5) / SLAB_DEPTHS);
}

// The same for volumes: view, sun, depth.
vec3 slab_place(Slab s) {
    return vec3(slab_place(1.0, s.mu_view).x, slab_place(s.optical_depth, s.mu_sun));
}

// Radiance of light that has forgotten where it came from, over its flux: Eddington's law.
float slab_exit(float mu_view) {
    return (2.0 + 3.0 * mu_view) / SLAB_FOUR_PI;
}

// A Gaussian around the sun: `times` deflections whose mean square is `spread` [rad^2] each. 2 (1 - cosine) is the angle's square.
vec3 slab_glow(float cosine, vec3 spread, vec3 times) {
    vec3 width = spread * times;
    return exp(-min(2.0 * (1.0 - cosine) / width, vec3(SLAB_DEEPEST))) / (0.25 * SLAB_FOUR_PI * width);
}

// Chance of three events or more where m are expected.
vec3 slab_three_or_more(vec3 m) {
    vec3 few = min(m, vec3(0.3));
    vec3 series = few * few * few / 6.0 * (1.0 - few * (0.75 - few * (0.3 - few / 12.0)));
    return mix(1.0 - exp(-m) * (1.0 + m + 0.5 * m * m), series, vec3(lessThan(m, vec3(0.3))));
}

// Share of a beam that meets a droplet.
float slab_met(float tau, float mu) {
    float x = tau / max(mu, SLAB_GRAZING);
    return x * slab_mean_decay(vec3(x)).x;
}

// Place of one of the four stacked tables of fluxes (order 1 up, down, order 2 up, down): their rows never mix.
vec2 slab_flux_place(float number, float tau, float mu) {
    vec2 place = slab_place(tau, mu);
    return vec2(place.x, (place.y + number) * 0.25);
}
