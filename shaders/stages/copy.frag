// A texture's texels as they are, times a factor: what the accumulator adds, and how it divides.
uniform sampler2D source;
uniform float factor;
layout(location = 0) out vec4 copied;

void main() {
    copied = texelFetch(source, ivec2(gl_FragCoord.xy), 0) * factor;
}
