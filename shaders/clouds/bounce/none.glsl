// No light between ground and clouds. Bouthors, Neyret and Lefebvre 2006 start from here.

vec3 bounce_ground(vec2 place) {
    return vec3(0.0);
}

vec3 bounce_cloud(vec2 place) {
    return vec3(0.0);
}
