"""Paths of light through the shells: every order of scattering, for matter that scatters within itself. Compiled.

A path goes to the next meeting with matter, an opaque face or the open. Where solids overlap, each lets the path meet
it on its own and the nearest meeting counts, for the extinctions add (a superposition of Poisson processes). Between
eight centres a meeting is drawn by the cell's largest extinction and taken by the chance of the place's own (Woodcock
et al. 1965); the sun is looked for at every meeting, through all shells, exactly.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from renderer.reference.shells_light import DARK, depth_between, face_at, scratch, sun_on, sunlight
from renderer.reference.shells_matter import (
    FAR,
    begin_cells,
    between,
    corner_densities,
    face_met,
    inner,
    leaves,
    matter,
    next_cells,
    through,
    uniform,
    wrapped,
)
from renderer.reference.shells_world import LEAF, NEAREST, OPAQUEST, STRAIGHT

LEAST = 1e-5
"""Opacity below which a ray is taken to meet nothing."""

GOES_ON = 8
"""Meetings after which a path ends by chance, as its weight falls."""


@inner
def _meeting_in(scene, tet, o, d, begin, end, state, work):
    """Distance of a path's next meeting with one tetrahedron's matter, FAR for none."""
    at, along, cell, crossing, values = work
    begin_cells(scene, tet, o, d, begin, at, along, cell, crossing)
    depth, height, width = scene.density.shape
    repeats = scene.kinds[2] != 0
    t = begin
    while t < end:
        until = max(min(min(crossing[0], crossing[1]), min(crossing[2], end)), t)
        if scene.kinds[0] == NEAREST:
            i, j = wrapped(cell[0], width, repeats), wrapped(cell[1], height, repeats)
            most = scene.density[min(max(cell[2], 0), depth - 1), j, i]
        else:
            most = corner_densities(scene, cell, values)
            if scene.kinds[0] == STRAIGHT:
                most = -math.log1p(-min(most, OPAQUEST)) / scene.numbers[0]
        s = t
        while most > 0.0:
            s -= math.log1p(-uniform(state)) / most
            if s >= until:
                break
            x, y, z = at[0] + s * along[0] - cell[0], at[1] + s * along[1] - cell[1], at[2] + s * along[2] - cell[2]
            if scene.kinds[0] == NEAREST or uniform(state) * most < between(scene, values, x, y, z):
                return s
        t = until
        next_cells(t, at, along, cell, crossing)
    return FAR


@inner
def _meeting(scene, o, d, far, state, work, stack, found):
    """A path's next meeting with any matter before `far`: the tetrahedron, -1 for none, and the distance."""
    order = scene.solids.order
    best = -1
    for n in range(leaves(scene.solids.boxes, o, d, far, stack, found)):
        for m in range(found[n] * LEAF, min(found[n] * LEAF + LEAF, order.shape[0])):
            begin, end = through(scene.planes[order[m]], o, d, far)
            if begin < end:
                t = _meeting_in(scene, order[m], o, d, begin, end, state, work)
                if t < far:
                    best, far = order[m], t
    return best, far


@inner
def _clear(scene, o, d, far, work, stack, found):
    """Transmittance of all matter before `far`."""
    order = scene.solids.order
    total = 0.0
    for n in range(leaves(scene.solids.boxes, o, d, far, stack, found)):
        for m in range(found[n] * LEAF, min(found[n] * LEAF + LEAF, order.shape[0])):
            begin, end = through(scene.planes[order[m]], o, d, far)
            if begin < end and total < DARK:
                total += depth_between(scene, order[m], o, d, begin, end, work)
    return math.exp(-total)


@inner
def _turned(d, cosine, turn):
    """A unit vector at an angle of given cosine to another."""
    sine = math.sqrt(max(1.0 - cosine * cosine, 0.0))
    sign = 1.0 if d[2] >= 0.0 else -1.0
    # Duff et al. 2017: two unit vectors across a third
    a = -1.0 / (sign + d[2])
    b = d[0] * d[1] * a
    x, y = sine * math.cos(turn), sine * math.sin(turn)
    return (
        x * (1.0 + sign * d[0] * d[0] * a) + y * b + cosine * d[0],
        x * sign * b + y * (sign + d[1] * d[1] * a) + cosine * d[1],
        -x * sign * d[0] - y * d[1] + cosine * d[2],
    )


@inner
def _lobe(cosine, g):
    """Henyey and Greenstein's phase function, 1/sr (1941)."""
    return (1.0 - g * g) / (4.0 * math.pi * (1.0 + g * g - 2.0 * g * cosine) ** 1.5)


@inner
def _draw_cosine(g, u):
    """A cosine of Henyey and Greenstein's."""
    if abs(g) < 1e-3:
        return 2.0 * u - 1.0
    part = (1.0 - g * g) / (1.0 - g + 2.0 * g * u)
    return min(max((1.0 + g * g - part * part) / (2.0 * g), -1.0), 1.0)


@inner
def _scatter(scene, tet, p, kept, one, work):
    """A meeting with matter: `kept` (3,) is what is left of the path; returns the matter's glow."""
    at, along, cell, crossing, values = work
    begin_cells(scene, tet, p, (0.0, 0.0, 0.0), 0.0, at, along, cell, crossing)
    corner_densities(scene, cell, values)
    matter(scene, cell, values, at[0] - cell[0], at[1] - cell[1], at[2] - cell[2], one)
    for c in range(3):
        kept[c] *= min(one[1 + c], 1.0)
    return one[7]


@inner
def _path(scene, o, d, scattering, state, work, stack, found, arrays, light):
    """Follow one path that meets something, for which it is begun anew: what it brings is added to `light` (3,).

    Args:
        scattering: asymmetry, orders, and what of the sky's radiance is below the horizon.
    """
    kept, one, albedo = arrays
    sun = (scene.lights[0, 0], scene.lights[0, 1], scene.lights[0, 2])
    kept[:] = 1.0
    order = 0
    while True:
        face, far, u, v = face_met(scene, o, d, FAR, 0.0, stack, found)
        tet, t = _meeting(scene, o, d, far, state, work, stack, found)
        if tet < 0 and face < 0:
            if order == 0:
                continue
            share = 1.0 if d[2] > 0.0 else scattering[2]
            for c in range(3):
                light[c] += kept[c] * share * scene.lights[2, c] / math.pi
            return
        order += 1
        if tet >= 0:
            p = (o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2])
            glow = _scatter(scene, tet, p, kept, one, work)
            for c in range(3):
                light[c] += kept[c] * glow * scene.lights[3, c]
            sent = _lobe(d[0] * sun[0] + d[1] * sun[1] + d[2] * sun[2], scattering[0])
            d_next = _turned(d, _draw_cosine(scattering[0], uniform(state)), 2.0 * math.pi * uniform(state))
        else:
            normal, flat = face_at(scene, face, d, u, v, albedo)
            lift = scene.numbers[2]
            p = (o[0] + t * d[0] + lift * flat[0], o[1] + t * d[1] + lift * flat[1], o[2] + t * d[2] + lift * flat[2])
            for c in range(3):
                kept[c] *= albedo[c]
            sent = sun_on(scene, normal, flat) / math.pi
            d_next = _turned(normal, math.sqrt(uniform(state)), 2.0 * math.pi * uniform(state))
        if sent > 0.0 and scene.lights[1, 0] + scene.lights[1, 1] + scene.lights[1, 2] > 0.0:
            sent *= sunlight(scene, p, work, stack, found)
            for c in range(3):
                light[c] += kept[c] * sent * scene.lights[1, c]
        if order >= scattering[1]:
            return
        o, d = p, d_next
        if order >= GOES_ON:
            stays = min(max(kept[0], max(kept[1], kept[2])), 1.0)
            if uniform(state) >= stays:
                return
            for c in range(3):
                kept[c] /= stays


@njit(cache=True, nogil=True, error_model="numpy")
def path_rows(scene, origins, directions, behind, begin, end, scattering, paths, seed, number, total, variance):
    """Follow the paths of one position of some rows of the picture.

    Args:
        origins, directions, behind: (H, W, 3), the last the background's radiance.
        scattering: as in `_path`. paths: of each ray, in proportion to its opacity.
        seed, number: of the random numbers, of the position.
        total: (H, W, 4) gets the premultiplied radiance and the opacity. variance: (H, W).

    Returns:
        True: any number of solids may share a place.
    """
    work, stack = scratch(), np.zeros(128, np.int64)
    found = np.zeros(max(scene.solids.boxes.shape[0], scene.faces.boxes.shape[0]), np.int64)
    arrays = (np.zeros(3), np.zeros(8), np.zeros(3))
    light = np.zeros(3)
    state = np.zeros(1, np.uint64)
    for row in range(begin, end):
        state[0] = np.uint64(((seed * 1009 + number) * 65536 + row) * 65536 + 1)
        for _ in range(8):
            uniform(state)
        for column in range(origins.shape[1]):
            o = (origins[row, column, 0], origins[row, column, 1], origins[row, column, 2])
            d = (directions[row, column, 0], directions[row, column, 1], directions[row, column, 2])
            face, far, _, _ = face_met(scene, o, d, FAR, 0.0, stack, found)
            left = 0.0 if face >= 0 else _clear(scene, o, d, far, work, stack, found)
            meets = 1.0 - left if left < 1.0 - LEAST else 0.0
            count = max(math.ceil(paths * meets), 2)
            mean, square = 0.0, 0.0
            for _ in range(count if meets > 0.0 else 0):
                light[:] = 0.0
                _path(scene, o, d, scattering, state, work, stack, found, arrays, light)
                brought = (light[0] + light[1] + light[2]) / 3.0
                mean += brought / count
                square += brought * brought / count
                for c in range(3):
                    total[row, column, c] += light[c] * meets / count
            for c in range(3):
                total[row, column, c] += left * behind[row, column, c]
            total[row, column, 3] += 1.0 - left
            variance[row, column] += meets * meets * max(square - mean * mean, 0.0) / (count - 1)
    return True
