// The four directions round that of the eye, blended bilinearly. Porquet 2005 names it as future work; formulas (c).
//
// Symbols: (theta, phi) of the view <-> directions, numbers of the face's hemisphere, with their weights (1).
// No claim: four pictures from four places are laid over each other, so that what lies deep in the box shows twice.

void selection_points(int face, vec3 place, vec3 to_eye, vec2 range, out uvec4 points, out vec4 weights) {
    ivec2 texel = face_texel(face_coordinates(face, place));
    ivec4 directions;
    hemisphere_around(to_face(face, to_eye), VIEW_AZIMUTHS, VIEW_ELEVATIONS, directions, weights);
    for (int k = 0; k < 4; k++) points[k] = seen_point(face, directions[k], texel);
}
