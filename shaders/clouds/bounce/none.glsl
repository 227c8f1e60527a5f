// No light between ground and clouds.

vec3 bounce_ground(vec2 place, BounceHere here) {
    return vec3(0.0);
}

vec3 bounce_cloud(vec2 place, BounceHere here) {
    return vec3(0.0);
}
