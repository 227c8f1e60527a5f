// Corners of triangles that are given where they lie in the framebuffer, -1 to 1.
in vec2 place;
void main() {
    gl_Position = vec4(place, 0.0, 1.0);
}
