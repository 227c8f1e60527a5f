// Triangles where a camera's rays meet them, each with the number of what it belongs to.
uniform mat4 view_projection;
uniform vec4 clip_first;  // planes on whose negative side nothing is drawn, where clip distances are switched on
uniform vec4 clip_second;
in vec3 position;  // m
in float owner;
flat out float number;

void main() {
    vec4 place = vec4(position, 1.0);
    gl_Position = view_projection * place;
    gl_ClipDistance[0] = dot(clip_first, place);
    gl_ClipDistance[1] = dot(clip_second, place);
    number = owner;
}
