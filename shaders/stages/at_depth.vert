// One triangle that covers the framebuffer at one depth, 0 to 1, so that depth tests choose the pixels that are drawn.
uniform float stage_depth;
void main() {
    vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
    gl_Position = vec4(corner, 2.0 * stage_depth - 1.0, 1.0);
}
