// The point that lies nearest the pixel's ray, among those that the directions round it see.
//
// Porquet 2005 with the depth correction of Gortler et al. 1996; formulas (c): an answer to the parallax of half a step between directions. For each of the four directions round the
// ray, a place on the ray is carried along that direction onto the face, the point seen there gives the place's next
// depth, and so on: the fixed point is where the ray itself meets the surface.
// Symbols: SELECTION_STEPS, carries a direction; selection_reach, farthest of a point from the ray [texels of the longest
// side].
// No claim: what no direction round the ray sees stays unseen.

vec3 from_face(int face, vec3 direction) {
    vec3 turned = vec3(direction.xy, direction.z * face_side(face));
    return face < 2 ? turned.zxy : face < 4 ? turned.xzy : turned;
}

// The four directions of a face's hemisphere round that of the eye, the nearest first.
ivec4 directions_round(int face, vec3 to_eye) {
    ivec4 round;
    vec4 weights;
    hemisphere_around(to_face(face, to_eye), VIEW_AZIMUTHS, VIEW_ELEVATIONS, round, weights);
    round = weights.x + weights.y < weights.z + weights.w ? round.zwxy : round;
    return weights.x + weights.z < weights.y + weights.w ? round.yxwz : round;
}

// The face that looks most towards the eye.
int face_towards(vec3 to_eye) {
    vec3 size = abs(to_eye);
    int axis = size.x > max(size.y, size.z) ? 0 : size.y > size.z ? 1 : 2;
    return 2 * axis + (to_eye[axis] > 0.0 ? 1 : 0);
}

void selection_points(int face, vec3 place, vec3 to_eye, out uvec4 points, out vec4 weights) {
    vec3 inverse = 1.0 / -to_eye;
    vec3 farther = max((box_low - place) * inverse, (box_high - place) * inverse);
    float span = min(farther.x, min(farther.y, farther.z));
    vec3 sides = box_high - box_low;
    float texel = max(sides.x, max(sides.y, sides.z)) / float(TEXELS);
    int other = face_towards(to_eye);
    ivec4 first = directions_round(face, to_eye);
    ivec4 second = directions_round(other, to_eye);
    int most = (other == face ? 4 : 8) * SELECTION_STEPS;
    float best = selection_reach * texel;
    float front = 1.0e30;
    float depth = 0.5 * span;
    vec2 within = vec2(0.0, span); // where the surface must be
    points = uvec4(NO_POINT);
    weights = vec4(1.0, 0.0, 0.0, 0.0);
    for (int n = 0; n < 4 * SELECTION_STEPS || (n < most && points.x == NO_POINT); n++) {
        int k = n / SELECTION_STEPS;
        bool begins = n == k * SELECTION_STEPS;
        depth = !begins ? depth : points.x == NO_POINT ? 0.5 * span : front;
        within = begins ? vec2(0.0, span) : within;
        int through = k < 4 ? face : other;
        int seen_from = k < 4 ? first[k] : second[k - 4];
        vec3 along = from_face(through, hemisphere_direction(seen_from, VIEW_AZIMUTHS, VIEW_ELEVATIONS));
        vec2 at = face_coordinates(through, onto_face(through, place - depth * to_eye, along));
        uint point = seen_point(through, seen_from, face_texel(at));
        bool found = point != NO_POINT && at == clamp(at, 0.0, 1.0);
        vec3 offset = place_of(surfel_texel(found ? point : 0u)) - place;
        float ahead = -dot(offset, to_eye);
        float away = found ? length(offset + ahead * to_eye) : 1.0e30;
        // What lies well before the best so far hides it; else the nearer to the ray is the better.
        bool before = ahead < front - 2.0 * texel;
        bool better = away < selection_reach * texel && (before || (away < best && ahead < front + 2.0 * texel));
        best = better ? away : best;
        front = better ? ahead : front;
        points.x = better ? point : points.x;
        bool deeper = !found || ahead > depth;
        within = deeper ? vec2(depth, within.y) : vec2(within.x, depth);
        bool inside = found && ahead > within.x && ahead < within.y;
        depth = inside ? ahead : 0.5 * (within.x + within.y);
    }
}
