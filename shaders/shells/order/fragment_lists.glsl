// Order by lists that each pixel sorts for itself. Yang, Hensley, Gruen & Thibieroz 2010, "Real-time concurrent linked list
// construction on the GPU"; here each list is one piece of memory, its length counted before.
//
// Symbols: first, last: where the pixel's list begins and ends; list_fragment, distance (m) and 4 cell + face of each.
// Cells come in the order of their middles, so that sorting by insertion has little to move.

void order_sort(int first, int last) {
    for (int here = first + 1; here < last; here++) {
        vec2 held = list_fragment[here];
        int place = here;
        while (place > first && list_fragment[place - 1].x > held.x) {
            list_fragment[place] = list_fragment[place - 1];
            place--;
        }
        list_fragment[place] = held;
    }
}
