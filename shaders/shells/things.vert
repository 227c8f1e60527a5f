// Other meshes of the scene where a camera's rays meet them.
uniform mat4 view_projection;
in vec3 position;  // m
in vec3 smoothed;  // unit normal of the corner
in vec3 facing;    // unit normal of the triangle
in vec3 albedo;
out vec3 thing_place;
out vec3 thing_smooth;
flat out vec3 thing_facing;
flat out vec3 thing_albedo;

void main() {
    gl_Position = view_projection * vec4(position, 1.0);
    thing_place = position;
    thing_smooth = smoothed;
    thing_facing = facing;
    thing_albedo = albedo;
}
