// The nearest direction of the hemisphere of each face. Porquet 2005: "selected by its hemisphere of visibility".
//
// Symbols: (theta, phi) of the view <-> direction, a number of the face's hemisphere; d <-> TEXELS.
// No claim: what is seen from half a step aside is drawn as if it were seen from here, so that edges leap.

void selection_points(int face, vec3 place, vec3 to_eye, vec2 range, out uvec4 points, out vec4 weights) {
    int direction = hemisphere_nearest(to_face(face, to_eye), VIEW_AZIMUTHS, VIEW_ELEVATIONS);
    points = uvec4(seen_point(face, direction, face_texel(face_coordinates(face, place))), uvec3(NO_POINT));
    weights = vec4(1.0, 0.0, 0.0, 0.0);
}
