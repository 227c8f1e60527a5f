// Where a fragment lies in the picture: pixels from the TOP-LEFT corner, centres at half integers, as lib/camera.glsl
// takes them. OpenGL counts fragments from the bottom-left corner.
vec2 picture_pixel(vec2 frag_coord, vec2 picture_size) {
    return vec2(frag_coord.x, picture_size.y - frag_coord.y);
}
