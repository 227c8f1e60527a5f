// Order by peeling: each pass keeps the nearest of what lies behind the pass before. Everitt 2001, "Interactive
// order-independent transparency"; Dufort 2005, section 4.2.
//
// Symbols: t, distance at which the ray comes into a cell (m); last, that of the layer before it; base, that of the opaque
// surface, or 0 where there is none. Layers are told apart by distances along the ray, which no
// buffer has rounded; the nearest of a pass is found by the depth buffer.

bool order_peeled(float t, float last, float base) {
    return t <= last || (base > 0.0 && t >= base);
}
