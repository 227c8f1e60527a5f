// A ray's way through a cell whose face was drawn: in by that face's plane, out by the nearest of the other three.
// Dufort 2005, sections 5.1.1 and 5.2.3; errata 002-8.
// Symbols: near, far, distances of entry and exit (m); slack, how far beside a face's true edge a fragment may lie (m), since
// hardware draws with corners rounded to 1/256 of a pixel. Without it, rays along a prism's side would find it empty.

void cell_cut(Ray ray, float enter, float slack, vec4 plane, inout float near, inout float far) {
    float fall = dot(plane.xyz, ray.direction);
    float outside = dot(plane.xyz, ray.origin + enter * ray.direction) + plane.w;
    float room = outside > 0.0 ? max(slack - outside, 0.0) : -outside;
    far = fall > 0.0 ? min(far, enter + room / fall) : far;
    float back = fall < 0.0 ? enter - (outside - slack) / fall : 1.0e30;
    near = fall <= 0.0 && outside > slack ? max(near, back) : near;
}

// Where the drawn face lies far beside the cell, nothing is between: pixels that are not drawn at all, which hardware shades
// along with their neighbours, would else march through the whole world.
Segment cell_segment(Ray ray, float enter, vec4 a, vec4 b, vec4 c, vec4 u, vec4 v, vec4 w) {
    float near = enter, far = 1.0e30, slack = pixel_width(enter) / 128.0;
    cell_cut(ray, enter, slack, a, near, far);
    cell_cut(ray, enter, slack, b, near, far);
    cell_cut(ray, enter, slack, c, near, far);
    bool between = near < far && far < 1.0e29;
    near = between ? near : enter;
    far = between ? far : enter;
#if THINGS == 1
    far = clamp(thing_distance(), near, far);
#endif
    return way_segment(ray, near, far, u, v, w);
}

// The same from a face's number, 4 cell + face, and the distance at which a ray meets it.
Segment cell_numbered(Ray ray, float near, int number) {
    int tet = number / 4, face = number % 4;
    tet_here = tet;
    return cell_segment(ray, near, tet_texel(tet, (face + 1) % 4), tet_texel(tet, (face + 2) % 4),
                        tet_texel(tet, (face + 3) % 4), tet_texel(tet, 4), tet_texel(tet, 5), tet_texel(tet, 6));
}
