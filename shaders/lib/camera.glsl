// The ray of a point of the picture, for every kind of camera.
//
// Twin of `rays` in renderer/world/camera.py, which derives these vectors; both evaluate one affine function.
// camera_origin, camera_origin_dx, camera_origin_dy: where rays start, m, and its change per pixel (orthographic only)
// camera_corner, camera_dx, camera_dy: direction of the top-left corner and its change per pixel (perspective only)

// pixel: from the top-left corner of the picture, in pixels; centres at half integers.
// origin: m. direction: unit vector.
void camera_ray(vec2 pixel, out vec3 origin, out vec3 direction) {
    origin = camera_origin + pixel.x * camera_origin_dx + pixel.y * camera_origin_dy;
    direction = normalize(camera_corner + pixel.x * camera_dx + pixel.y * camera_dy);
}
