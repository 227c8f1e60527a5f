// The project's unit of time: 64 trilinear samples of a volume a pixel, composited front to back without an early stop.
uniform sampler3D volume;
uniform vec2 size;
layout(location = 0) out vec4 composited;

void main() {
    vec2 uv = gl_FragCoord.xy / size;
    vec4 sum = vec4(0.0);
    for (int i = 0; i < 64; i++) {
        vec4 texel = textureLod(volume, vec3(uv, (float(i) + 0.5) / 64.0), 0.0);
        float alpha = 0.05 * texel.a;
        sum += (1.0 - sum.a) * alpha * vec4(texel.rgb, 1.0);
    }
    composited = sum;
}
