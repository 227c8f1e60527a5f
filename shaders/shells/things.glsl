// Other meshes of the scene: what they leave of the sun, and where they end a ray. Dufort 2005, section 5.3.1; Williams 1978,
// "Casting curved shadows on curved surfaces".
//
// Symbols: thing_map, of the nearest triangle from the sun's side in each texel: its distance in the texel's middle (m), and by how much
// that grows from texel to texel across and up; with these the triangle's own plane is what a place is compared with, so that a surface
// does not shade itself; where it rises towards the sun its middle counts, for there another triangle of the same body may begin. Which texel is read differs from sample to sample by up to half of one, whose mean is the filter. thing_seen,
// light and distance (m) of what is seen of them, 0 where nothing is.

const float THING_BIAS = 1.0; // texels behind the plane that are lit still: where the next triangle bends away from it

float thing_visibility(vec3 point) {
    vec3 from = point - thing_origin;
    float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    vec2 jitter = fract(vec2(noise, 7.0 * noise) + sample_shift * vec2(0.7548776662, 0.5698402910)) - 0.5;
    vec2 place = vec2(dot(from, thing_across), thing_side - dot(from, thing_down));
    vec2 texel = floor(place + jitter), off = place - texel - 0.5;
    bool inside = min(texel.x, texel.y) >= 0.0 && max(texel.x, texel.y) < thing_side;
    vec3 held = texelFetch(thing_map, ivec2(clamp(texel, 0.0, thing_side - 1.0)), 0).xyz;
    float surface = held.x + max(dot(held.yz, off), 0.0) + THING_BIAS * thing_texel;
    return inside && dot(from, thing_along) > surface ? 0.0 : 1.0;
}

float thing_limit = 1.0e30; // where a thing ends the ray, m

// Distance (m) at which a thing ends the ray of this pixel.
float thing_distance() {
    float t = texelFetch(thing_seen, ivec2(gl_FragCoord.xy), 0).a;
    return t > 0.0 ? t : 1.0e30;
}
