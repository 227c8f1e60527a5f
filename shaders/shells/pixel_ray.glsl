// The ray of a fragment, and how wide a pixel is along it.

Ray pixel_ray(vec2 frag_coord) {
    Ray ray;
    camera_ray(picture_pixel(frag_coord, picture_size) - 0.5 + pixel_offset, ray.origin, ray.direction);
    return ray;
}

float pixel_width(float distance) {
    return pixel_side + pixel_angle * distance;
}

// What a picture's buffer holds of light and opacity: `buffer_white` stands for 1.
vec4 buffer_of(vec4 sum) {
    return sum / vec4(vec3(buffer_white), 1.0);
}
