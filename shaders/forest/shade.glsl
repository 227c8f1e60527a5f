// What a point of canopy or ground sends towards the eye: albedo / pi (E_sun V f + E_sky a), times the height factor.
// Symbols: E_sun sun_irradiance [W/m2, normal to the beam], E_sky sky light [W/m2], V shadow_visibility, f light_factor, a ambient share.
// The slots' functions are composed in front of this file.

#include "forest/patches.glsl"

const float INVERSE_PI = 0.3183098861837907;

vec3 outgoing(vec4 place, vec4 voxel, float level) {
    bool on_ground = place.w == GROUND;
    float h = max(place.w, 0.0);
    vec2 uv = atlas_coordinate(place.xy);
    vec4 texel = textureLod(pattern_normal, vec3(uv, h), level);
    vec3 slope = ground_normal(place.xy);
    vec3 normal = on_ground ? slope : normalize(texel.xyz * 2.0 - 1.0 + vec3(0.0, 0.0, 1e-4));
    float wooded = on_ground ? wooded_at(place.xy) : 1.0;
    float ambient = mix(1.0, texel.a, wooded) * (on_ground ? 0.5 + 0.5 * slope.z : 1.0);
    float factor = mix(1.0, height_factor(h), wooded);
    vec3 leaf = albedo_of(voxel) * (1.0 + ground_tint_strength * tint_of(foot_of(place.xy, voxel)));
    vec3 soil = ground_albedo * (1.0 + ground_patches * patches_at(place.xy));
    vec3 albedo = on_ground ? soil : leaf;
    float visible = shadow_visibility(place.xyz, h, uv);
    return albedo * INVERSE_PI * (sun_irradiance * visible * light_factor(normal, slope) + sky_light(ambient)) * factor;
}
