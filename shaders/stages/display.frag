// The displayed picture of a linear one: mean of the samples, exposure, tone curve, background, sRGB, dither.
// Row 0 of the target is the top row of the picture, so that reading it back needs no flip.
#include "lib/display.glsl"

uniform sampler2D source;      // sum of `samples` premultiplied radiances, W m-2 sr-1, bottom row first
uniform float samples;
uniform float exposure_ev;     // EV
uniform int curve;             // DISPLAY_LINEAR or DISPLAY_FILMIC
uniform vec3 background;       // linear display light behind the picture, [0, 1]
layout(location = 0) out vec4 shown;

void main() {
    ivec2 size = textureSize(source, 0);
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 mean = texelFetch(source, ivec2(pixel.x, size.y - 1 - pixel.y), 0) / samples;
    vec3 light = display_curve(mean.rgb * exp2(exposure_ev), curve);
    light += (1.0 - clamp(mean.a, 0.0, 1.0)) * background;
    shown = vec4(display_srgb(light) + display_dither(pixel) / 255.0, 1.0);
}
