// Order by a window of ORDER_K cells a pixel. Callahan, Ikits, Comba & Silva 2005, "Hardware-assisted visibility sorting for
// unstructured volume rendering", section 3; Dufort 2005, section 4.3.1.
//
// Symbols: fragment, distance (m) and 4 cell + face; window_held, the pixel's window; window_last, the farthest distance that
// has left it; window_wrong, how many left it too late. A fragment is wrong exactly when it comes more than k places too late.

const vec2 WINDOW_EMPTY = vec2(-1.0e30, -1.0);

// Puts a fragment into the window, and returns the nearest of all, which falls out; an empty one as long as there is room.
vec2 order_through(int pixel, vec2 fragment) {
    vec2 held = fragment;
    for (int place = pixel * ORDER_K; place < (pixel + 1) * ORDER_K; place++) {
        vec2 there = window_held[place];
        bool nearer = there.x < held.x;
        window_held[place] = nearer ? held : there;
        held = nearer ? there : held;
    }
    return held;
}

// Counts what leaves the window after something farther, by more than what rounded corners account for.
void order_leaves(int pixel, vec2 held) {
    if (held.x < window_last[pixel] - pixel_width(held.x) / 128.0) window_wrong[pixel]++;
    window_last[pixel] = max(window_last[pixel], held.x);
}
