// The ray of a fragment, and how wide a pixel is along it.

Ray pixel_ray(vec2 frag_coord) {
    Ray ray;
    camera_ray(picture_pixel(frag_coord, picture_size) - 0.5 + pixel_offset, ray.origin, ray.direction);
    return ray;
}

float pixel_width(float distance) {
    return pixel_side + pixel_angle * distance;
}
