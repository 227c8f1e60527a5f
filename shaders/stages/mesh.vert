// Triangles where a camera's rays meet them, each with the number of what it belongs to.
uniform mat4 view_projection;
in vec3 position;  // m
in float owner;
flat out float number;

void main() {
    gl_Position = view_projection * vec4(position, 1.0);
    number = owner;
}
