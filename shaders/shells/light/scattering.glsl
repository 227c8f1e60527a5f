// Matter scatters light within itself. The first time: the sun's light that is left at a place, by Henyey and Greenstein's phase
// function (1941). Later orders, and the sky: Sloan, Kautz and Snyder 2002, transfer precomputed for the texture's block.
//
// Symbols: g, light_lobe; mu, cosine between the ray of the eye and the direction to the sun, that of the scattering angle; light_transfer,
// four blocks one over the other: of the sky's radiance with how steeply it came, F0 in colours, F1 with G0, and G1, as
// renderer/shells/transfer.py has them; lobe, G over F, mean cosine to the sun of the light that comes to a place. colour: the share of light that a meeting leaves.
// Deviations: the block lies level and repeats, whatever the shell does, and where it leans the sky is a smaller one; of how light
// depends on the sun four harmonics are kept.
// What it does not claim: surfaces within matter. Normals are not read, and voxels of the table blur what is solid.

const float LIGHT_PI = 3.14159265358979;

vec4 light_read(vec3 place, float part) {
    float layers = 0.25 * float(textureSize(light_transfer, 0).z);
    float level = clamp(place.z * layers, 0.5, layers - 0.5);
    return textureLod(light_transfer, vec3(place.xy, 0.25 * (part + level / layers)), 0.0);
}

float light_phase(float g, float mu) {
    return (1.0 - g * g) / (4.0 * LIGHT_PI * pow(1.0 + g * g - 2.0 * g * mu, 1.5));
}

// Later orders of the sun's light, 1/sr.
vec3 light_later(vec4 f0, vec4 f1, vec4 g1, vec3 sun, float mu) {
    float grey = max(dot(f0.rgb, vec3(1.0 / 3.0)), 1.0e-9);
    float all = max(grey + 3.0 * dot(f1.xyz, sun), 1.0e-3 * grey);
    float lobe = clamp((f1.w + 3.0 * dot(g1.xyz, sun)) / all, -0.95, 0.95);
    return f0.rgb * (all / grey * light_phase(light_lobe * lobe, mu));
}

vec3 light_source(Ray ray, float distance, vec3 place, float level, Matter matter, mat3 gradients) {
    float mu = dot(ray.direction, sun_direction);
    vec3 sun = shell_size * (sun_direction * gradients);
    sun /= max(length(sun), 1.0e-20);
    vec3 later = light_later(light_read(place, 1.0), light_read(place, 2.0), light_read(place, 3.0), sun, mu);
    vec4 sky = light_read(place, 0.0);
    vec3 up = gradients[2] / max(length(gradients[2]), 1.0e-20);
    float rise = 3.0 * light_lobe * dot(ray.direction, up) * sky.a / max(dot(sky.rgb, vec3(1.0 / 3.0)), 1.0e-9);
    sky.rgb *= 0.5 * (1.0 + up.z) * max(1.0 + rise, 0.0);
    vec3 arriving = sun_irradiance * (light_phase(light_lobe, mu) * sun_visibility(ray.origin + distance * ray.direction) + later)
                  + sky_irradiance / LIGHT_PI * sky.rgb;
    float glow = matter_normal(place, level, matter, gradients).w;
    return matter.colour * (arriving + glow * voxels_glow);
}

// The surface is lit by the sun that is left there, and by what comes down to it: of the mean light right over it, one half comes
// down, L, and one half comes up, colour (sun / pi + L).
vec3 light_base(vec3 point, vec3 normal, bool sunlit, vec3 colour) {
    float facing = sunlit ? max(dot(normal, sun_direction), 0.0) : 0.0;
    vec3 direct = sun_irradiance * (facing * sun_visibility(point)) / LIGHT_PI;
    vec4 u = tet_texel(tet_here, 4), v = tet_texel(tet_here, 5), w = tet_texel(tet_here, 6);
    vec3 place = vec3(vec2(dot(u.xyz, point) + u.w, dot(v.xyz, point) + v.w) + texture_slide, 0.0);
    vec3 sun = shell_size * (sun_direction * mat3(u.xyz, v.xyz, w.xyz));
    vec4 f0 = light_read(place, 1.0);
    float grey = max(dot(f0.rgb, vec3(1.0 / 3.0)), 1.0e-9);
    float all = max(grey + 3.0 * dot(light_read(place, 2.0).xyz, sun) / max(length(sun), 1.0e-20), 0.0);
    vec3 mean = sun_irradiance * f0.rgb * (all / grey / (4.0 * LIGHT_PI))
              + sky_irradiance / LIGHT_PI * light_read(place, 0.0).rgb * (0.5 * (1.0 + normal.z));
    return colour * (direct + max(2.0 * mean - colour * direct, 0.0) / (1.0 + colour));
}
