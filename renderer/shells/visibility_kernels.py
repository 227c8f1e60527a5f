"""Loops of the visibility order: faces scan-converted, fragments sorted per pixel, cells sorted by their relations."""

from __future__ import annotations

import numba
import numpy as np


@numba.njit(cache=True)
def fragments(corners, width, height):
    """Fragments of triangles, pixel by pixel: an A-buffer.

    Triangles are scan-converted in homogeneous coordinates, so that corners behind the eye need no clipping (Olano &
    Greer 1997, "Triangle scan conversion using 2D homogeneous coordinates", section 4).

    Args:
        corners: (F, 3, 4) float64, in clip coordinates. width, height: in pixels.

    Returns:
        start (width * height + 1,) of each pixel's list, depth (N,) in device coordinates and triangle (N,) int32.
    """
    start = np.zeros(width * height + 1, np.int64)
    depth, triangle = np.empty(0), np.empty(0, np.int32)
    filled = np.empty(0, np.int64)
    for turn in range(2):
        if turn == 1:
            for pixel in range(width * height):
                start[pixel + 1] += start[pixel]
            depth, triangle = np.empty(start[-1]), np.empty(start[-1], np.int32)
            filled = start[:-1].copy()
        for f in range(len(corners)):
            x0, y0, z0, w0 = corners[f, 0]
            x1, y1, z1, w1 = corners[f, 1]
            x2, y2, z2, w2 = corners[f, 2]
            determinant = x0 * (y1 * w2 - y2 * w1) + x1 * (y2 * w0 - y0 * w2) + x2 * (y0 * w1 - y1 * w0)
            if determinant == 0.0 or (w0 <= 0 and w1 <= 0 and w2 <= 0):
                continue
            low_x, high_x, low_y, high_y = -1.0, 1.0, -1.0, 1.0
            if w0 > 0 and w1 > 0 and w2 > 0:
                low_x, high_x = min(x0 / w0, x1 / w1, x2 / w2), max(x0 / w0, x1 / w1, x2 / w2)
                low_y, high_y = min(y0 / w0, y1 / w1, y2 / w2), max(y0 / w0, y1 / w1, y2 / w2)
            first_i = max(int(np.ceil((max(low_x, -1.0) + 1) * 0.5 * width - 0.5)), 0)
            last_i = min(int(np.floor((min(high_x, 1.0) + 1) * 0.5 * width - 0.5)), width - 1)
            first_j = max(int(np.ceil((max(low_y, -1.0) + 1) * 0.5 * height - 0.5)), 0)
            last_j = min(int(np.floor((min(high_y, 1.0) + 1) * 0.5 * height - 0.5)), height - 1)
            part = 1.0 / determinant
            ax, ay, ac = (y1 * w2 - y2 * w1) * part, (x2 * w1 - x1 * w2) * part, (x1 * y2 - x2 * y1) * part
            bx, by, bc = (y2 * w0 - y0 * w2) * part, (x0 * w2 - x2 * w0) * part, (x2 * y0 - x0 * y2) * part
            cx, cy, cc = (y0 * w1 - y1 * w0) * part, (x1 * w0 - x0 * w1) * part, (x0 * y1 - x1 * y0) * part
            for j in range(first_j, last_j + 1):
                y = (j + 0.5) * 2 / height - 1
                a0, b0, c0 = ay * y + ac, by * y + bc, cy * y + cc
                for i in range(first_i, last_i + 1):
                    x = (i + 0.5) * 2 / width - 1
                    a, b, c = ax * x + a0, bx * x + b0, cx * x + c0
                    if a < 0 or b < 0 or c < 0 or a + b + c <= 0:
                        continue
                    pixel = j * width + i
                    if turn == 0:
                        start[pixel + 1] += 1
                    else:
                        place = filled[pixel]
                        depth[place] = a * z0 + b * z1 + c * z2
                        triangle[place] = f
                        filled[pixel] += 1
    return start, depth, triangle


@numba.njit(cache=True)
def neighbours_in_depth(start, depth, triangle, cell, enters, cells):
    """Relations of cells that follow each other along a pixel's ray: where one is left and the next one entered.

    Args:
        start, depth, triangle: what `fragments` gave; lists are sorted in place.
        cell: (F,) of each triangle. enters: (F,) bool, whether rays come into the cell by it.
        cells: how many there are.

    Returns:
        before, after (N,) int32 cells, some more than once, and in how many pixels (N,) int64.
    """
    most = 0
    for pixel in range(len(start) - 1):
        most += max(start[pixel + 1] - start[pixel] - 1, 0)
    before, after, pixels = np.empty(most, np.int32), np.empty(most, np.int32), np.empty(most, np.int64)
    known, count = np.full(cells, -1, np.int64), 0
    for pixel in range(len(start) - 1):
        first, last = start[pixel], start[pixel + 1]
        for here in range(first + 1, last):
            z, f = depth[here], triangle[here]
            place = here
            # A cell is left before one at the same depth is entered.
            while place > first and (
                z < depth[place - 1] or (z == depth[place - 1] and enters[triangle[place - 1]] and not enters[f])
            ):
                depth[place], triangle[place] = depth[place - 1], triangle[place - 1]
                place -= 1
            depth[place], triangle[place] = z, f
        for here in range(first, last - 1):
            one, other = triangle[here], triangle[here + 1]
            a, b = cell[one], cell[other]
            if enters[one] or not enters[other] or a == b:
                continue
            if known[a] >= 0 and after[known[a]] == b:
                pixels[known[a]] += 1
                continue
            before[count], after[count], pixels[count] = a, b, 1
            known[a] = count
            count += 1
    return before[:count], after[:count], pixels[:count]


@numba.njit(cache=True)
def by_cell(end, cells):
    """Relations by the cell at one end: where those of each begin (cells + 1,), and their numbers (N,)."""
    start, numbers = np.zeros(cells + 1, np.int64), np.empty(len(end), np.int64)
    for e in range(len(end)):
        start[end[e]] += 1
    for cell in range(cells):
        start[cell + 1] += start[cell]
    for e in range(len(end) - 1, -1, -1):
        start[end[e]] -= 1
        numbers[start[end[e]]] = e
    return start, numbers


@numba.njit(cache=True)
def cycle_behind(cell, before, cost, in_edge, scan, gone, seen, mark, path):
    """The cycle that one comes into by going back from a cell, last first in `path`: its cheapest relation and length.

    Args:
        in_edge: relations that lead to each cell, from `scan` on. gone: (N,) 1 where a relation is done with.
        seen: (cells,) less than `mark`, which is written there.
    """
    while seen[cell] != mark:
        seen[cell] = mark
        while gone[in_edge[scan[cell]]] == 1:
            scan[cell] += 1
        cell = before[in_edge[scan[cell]]]
    stop, cheapest, length = cell, in_edge[scan[cell]], 0
    while length == 0 or cell != stop:
        e = in_edge[scan[cell]]
        if cost[e] < cost[cheapest]:
            cheapest = e
        path[length] = cell
        length += 1
        cell = before[e]
    return cheapest, length


@numba.njit(cache=True)
def sorted_cells(before, after, cost, cells, told):
    """Cells such that each stands before those that it hides (Kahn 1962), cycles broken where it costs least.

    Args:
        before, after: (N,) int32, relations, each once. cost: (N,) of giving one up. cells: how many there are.
        told: (M,) int32, -1: filled with the cells of the first cycles, each led by their number, as far as it holds.

    Returns:
        order (cells,) int32, and how many cycles were broken.
    """
    out_start, out_edge = by_cell(before, cells)
    in_start, in_edge = by_cell(after, cells)
    waiting, scan = np.zeros(cells, np.int64), np.zeros(cells, np.int64)
    for cell in range(cells):
        scan[cell], waiting[cell] = in_start[cell], in_start[cell + 1] - in_start[cell]
    gone, done, seen = np.zeros(len(before), np.int8), np.zeros(cells, np.int8), np.zeros(cells, np.int64)
    order, path = np.empty(cells, np.int32), np.empty(cells, np.int32)
    head, tail, cycles, left, spoken = 0, 0, 0, 0, 0
    for cell in range(cells):
        if waiting[cell] == 0:
            order[tail] = cell
            tail += 1
    while head < cells:
        while head < tail:
            cell = order[head]
            head += 1
            done[cell] = 1
            for k in range(out_start[cell], out_start[cell + 1]):
                e = out_edge[k]
                if gone[e] == 0:
                    gone[e] = 1
                    waiting[after[e]] -= 1
                    if waiting[after[e]] == 0:
                        order[tail] = after[e]
                        tail += 1
        if head == cells:
            break
        # Every cell that is left waits for one that is left: going back from any of them leads into a cycle.
        while done[left] == 1:
            left += 1
        cycles += 1
        cheapest, length = cycle_behind(left, before, cost, in_edge, scan, gone, seen, cycles, path)
        if spoken + length < len(told):
            told[spoken] = length
            for k in range(length):
                told[spoken + length - k] = path[k]
            spoken += 1 + length
        gone[cheapest] = 1
        waiting[after[cheapest]] -= 1
        if waiting[after[cheapest]] == 0:
            order[tail] = after[cheapest]
            tail += 1
    return order, cycles
