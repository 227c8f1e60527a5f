// Order by walking: each ray goes from tetrahedron to tetrahedron through the faces they share. After Garrity 1990, "Raytracing
// irregular volume data"; formulas e, "Per-ray walk".
//
// Symbols: tet, enter: where the ray comes into the shell (m); sum: light and opacity gathered so far, front to back.
// The order along each ray is exact without any sorting, cycles do no harm, and the walk ends where nothing more is seen.

// Returns whether the ray met the opaque surface on its way.
bool order_walk(Ray ray, int tet, float enter, inout vec4 sum) {
    int steps = 0, face = -1, last = tet;
    do {
        tet_here = tet;
        Exit exit = tet_exit(ray, tet, enter);
#if THINGS == 1
        exit.t = clamp(thing_limit, enter, exit.t);
#endif
        sampling_segment(ray, tet_segment(ray, tet, enter, exit.t), sum);
        sum = accumulation_kept(sum);
        enter = exit.t;
        // Chosen, though the answer is known: Mesa's drivers for CPUs take what a loop only sets from its last turn, whichever
        // pixel of a few that took, and read at once what is read again behind the loop.
        bool going = steps < ORDER_STEPS;
        face = going ? exit.face : face;
        last = going ? tet : last;
        tet = tet_beyond(tet, face);
#if THINGS == 1
        tet = enter < thing_limit ? tet : BEYOND_TOP;
#endif
        steps++;
    } while (tet >= 0 && steps < ORDER_STEPS && sum.a < OPAQUE);
#if BASE_OPAQUE == 1
    if (tet == BEYOND_BASE) {
        base_met(ray, last, face, enter, sum);
        return true;
    }
#endif
#if THINGS == 1
    if (enter >= thing_limit) return true;
#endif
    return false;
}
