// Cells' faces where a camera's rays meet them, each with its cell's planes and map, read once a vertex. A face's last corner
// says which it is: `owner` of corner c of a cell is 4 cell + (c + 3) % 4, the number of the one face that ends there.
#include "shells/tetrahedra.glsl"
in vec3 position;  // m
in float owner;
flat out float number;
flat out vec4 cell_entry, cell_a, cell_b, cell_c, cell_u, cell_v, cell_w;

void main() {
    gl_Position = view_projection * vec4(position, 1.0);
    number = owner;
    int which = int(owner + 0.5), tet = which / 4, face = which % 4;
    cell_entry = tet_texel(tet, face);
    cell_a = tet_texel(tet, (face + 1) % 4);
    cell_b = tet_texel(tet, (face + 2) % 4);
    cell_c = tet_texel(tet, (face + 3) % 4);
    cell_u = tet_texel(tet, 4);
    cell_v = tet_texel(tet, 5);
    cell_w = tet_texel(tet, 6);
}
