// Sun or no sun, by the depth at which a map's ray has passed as much opacity as a surface would have. Dufort 2005, section 5.3.1;
// Williams 1978, "Casting curved shadows on curved surfaces".
//
// Symbols: depth, distance from the sun's side (m) of the first place where the way's opacity passes `opacity`,
// or of the opaque surface; places no farther behind it than shadow_bias texels are lit. Too small a bias speckles the matter that
// makes the shadow (acne), too large a one lifts shadows off; what is semi-transparent casts a whole shadow or none.

float shadow_visibility(vec3 point) {
    vec3 from = point - shadow_origin;
    vec2 place = vec2(dot(from, shadow_across), dot(from, shadow_down));
    ivec2 texel = clamp(ivec2(place.x, shadow_side - place.y), ivec2(0), ivec2(shadow_side) - 1);
    float depth = texelFetch(shadow_depth, texel, 0).x;
    return dot(from, shadow_along) > depth + shadow_bias * shadow_texel ? 0.0 : 1.0;
}
