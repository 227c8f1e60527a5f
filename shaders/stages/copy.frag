// A texture's texels as they are, or divided: what the accumulator adds, and how it takes the mean.
uniform sampler2D source;
uniform float divisor;
layout(location = 0) out vec4 copied;

void main() {
    copied = texelFetch(source, ivec2(gl_FragCoord.xy), 0) / divisor;
}
