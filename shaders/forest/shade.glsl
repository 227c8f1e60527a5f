// What a point of canopy or ground sends towards the eye: E_sun V f + S / pi, times the height factor.
// Symbols: E_sun sun_irradiance [W/m2, normal to the beam], S what it makes of the sky's light [W/m2], V shadow_visibility, f light_reflected [1/sr] (on the
// ground albedo / pi n.s), place.w h in the canopy, h + WOOD in wood, GROUND.
// The slots' functions are composed in front of this file.

#include "lib/patches.glsl"
#include "forest/first_look.glsl"

vec3 outgoing(vec4 place, vec4 voxel, float level, vec3 to_eye) {
    bool on_ground = place.w == GROUND;
    bool opaque = place.w >= WOOD;
    float h = max(opaque ? place.w - WOOD : place.w, 0.0);
    vec2 uv = atlas_coordinate(place.xy);
    vec4 texel = textureLod(pattern_normal, vec3(uv, h), level);
    vec3 slope = ground_normal(place.xy);
    vec3 mean = texel.xyz * 2.0 - 1.0 + vec3(0.0, 0.0, 1e-4);
    float kappa = length(mean);
    vec3 leaf = albedo_of(voxel) * (1.0 + ground_tint_strength * tint_of(foot_of(place.xy, voxel)));
    vec3 passed = opaque ? vec3(0.0) : min(ground_translucency * ground_glow * leaf, max(1.0 - leaf, 0.0));
    Matter matter = Matter(leaf, passed, mean / kappa, min(kappa, 1.0), slope, vec3(uv, h), level);
    vec3 soil = ground_albedo * (1.0 + ground_patches * patches_at(place.xy));
    vec3 sun_answer = on_ground ? soil * INVERSE_PI * max(dot(slope, sun_direction), 0.0) : light_reflected(matter, to_eye);
    float wooded = on_ground ? wooded_at(place.xy) : 1.0;
    Skylight light = sky_light(Spot(place.xyz, matter.place, level, wooded, mix(1.0, texel.a, wooded)));
    vec3 from_sky = on_ground ? sky_on_ground(soil, slope, light) : sky_answer(matter, to_eye, light);
    float factor = mix(1.0, height_factor(h), wooded);
#if LOOK > 1
    float visible = looked_visibility();
#else
    float visible = shadow_visibility(place.xyz, h, uv);
#endif
    return (sun_irradiance * visible * sun_answer + INVERSE_PI * from_sky) * factor;
}
