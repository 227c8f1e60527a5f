"""Light in the shells' reference: what the sun sends through them to a place, and what matter makes of it. Compiled."""

from __future__ import annotations

import math

import numpy as np

from renderer.reference.shells_matter import (
    FAR,
    begin_cells,
    between,
    corner_densities,
    face_met,
    inner,
    leaves,
    next_cells,
    through,
    uniform,
    wrapped,
)
from renderer.reference.shells_world import LEAF, NEAREST, STRAIGHT, UNLIT

DARK = 25.0
"""Optical depth behind which no light is left: 1.4e-11."""

STRATA = 1024
"""Most strata of sunlight along a ray."""

NODE = 0.5 - 0.5 / math.sqrt(3.0)
"""Where Gauss and Legendre's first of two points lies: exact for cubics, as extinction is along a ray in a cell."""


@inner
def depth_between(scene, tet, o, d, begin, end, work):
    """Optical depth of a way inside one tetrahedron."""
    at, along, cell, crossing, values = work
    begin_cells(scene, tet, o, d, begin, at, along, cell, crossing)
    depth, height, width = scene.density.shape
    repeats = scene.kinds[2] != 0
    parts = 2 if scene.kinds[0] == STRAIGHT else 1
    t, total = begin, 0.0
    while t < end and total < DARK:
        until = max(min(min(crossing[0], crossing[1]), min(crossing[2], end)), t)
        if scene.kinds[0] == NEAREST:
            i, j = wrapped(cell[0], width, repeats), wrapped(cell[1], height, repeats)
            total += (until - t) * scene.density[min(max(cell[2], 0), depth - 1), j, i]
        elif until > t and corner_densities(scene, cell, values) > 0.0:
            step = (until - t) / parts
            for n in range(2 * parts):
                s = t + step * (n // 2 + (NODE if n % 2 == 0 else 1.0 - NODE))
                x, y, z = (at[0] + s * along[0] - cell[0], at[1] + s * along[1] - cell[1],
                           at[2] + s * along[2] - cell[2])  # fmt: skip
                total += 0.5 * step * between(scene, values, x, y, z)
        t = until
        next_cells(t, at, along, cell, crossing)
    return total


@inner
def sunlight(scene, o, work, stack, found):
    """Share of the sun's light that arrives at a place: through all shells, 0 behind a face."""
    d = (scene.lights[0, 0], scene.lights[0, 1], scene.lights[0, 2])
    if face_met(scene, o, d, FAR, FAR, stack, found)[0] >= 0:
        return 0.0
    order = scene.solids.order
    total = 0.0
    for n in range(leaves(scene.solids.boxes, o, d, FAR, stack, found)):
        for m in range(found[n] * LEAF, min(found[n] * LEAF + LEAF, order.shape[0])):
            begin, end = through(scene.planes[order[m]], o, d, FAR)
            if begin < end:
                total += depth_between(scene, order[m], o, d, begin, end, work)
                if total > DARK:
                    return 0.0
    return math.exp(-total)


@inner
def add_source(scene, tet, found, own, sunny):
    """Add what matter sends for each unit of its extinction: always, and if the whole sun shone on it.

    Args:
        found: (8,) extinction, colour, normal, glow. own, sunny: (3,) get extinction times radiance.
    """
    numbers, lights = scene.numbers, scene.lights
    extinct, glow = found[0], found[7]
    if scene.kinds[1] == UNLIT:
        for c in range(3):
            own[c] += extinct * found[1 + c] * (numbers[1] + glow * lights[3, c])
        return
    turn = scene.turns[tet]
    x = turn[0, 0] * found[4] + turn[0, 1] * found[5] + turn[0, 2] * found[6]
    y = turn[1, 0] * found[4] + turn[1, 1] * found[5] + turn[1, 2] * found[6]
    z = turn[2, 0] * found[4] + turn[2, 1] * found[5] + turn[2, 2] * found[6]
    long = math.sqrt(x * x + y * y + z * z)
    mean = min(math.sqrt(found[4] ** 2 + found[5] ** 2 + found[6] ** 2), 1.0)
    scale = mean / long if long > 0.0 else 0.0
    facing = max(scale * (x * lights[0, 0] + y * lights[0, 1] + z * lights[0, 2]), 0.0) + 0.25 * (1.0 - mean)
    sky = 0.5 * (1.0 + scale * z)
    for c in range(3):
        albedo = extinct * found[1 + c]
        own[c] += albedo * (lights[2, c] * sky / math.pi + glow * lights[3, c])
        sunny[c] += albedo * lights[1, c] * facing / math.pi


@inner
def _picture(scene, face, x, y, c):
    """A picture's value, bilinear, repeating; a globe's ends at the poles."""
    begin, rows, columns = scene.pictures[face, 0], scene.pictures[face, 1], scene.pictures[face, 2]
    x, y = x * columns - 0.5, y * rows - 0.5
    i, j = math.floor(x), math.floor(y)
    x, y = x - i, y - j
    i, right = i % columns, (i + 1) % columns
    if scene.pictures[face, 3] != 0:
        j, down = min(max(j, 0), rows - 1), min(max(j + 1, 0), rows - 1)
    else:
        j, down = j % rows, (j + 1) % rows
    one, two = begin + j * columns, begin + down * columns
    upper = scene.texels[one + i, c] * (1.0 - x) + scene.texels[one + right, c] * x
    lower = scene.texels[two + i, c] * (1.0 - x) + scene.texels[two + right, c] * x
    return upper * (1.0 - y) + lower * y


@inner
def face_at(scene, face, d, u, v, albedo):
    """What a ray meets of a face: reflectance in `albedo` (3,), and towards the eye, the smooth normal and the face's
    own, both unit."""
    a, b, c = scene.corners[face, 0], scene.corners[face, 1], scene.corners[face, 2]
    x = (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1])
    y = (b[2] - a[2]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[2] - a[2])
    z = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    scale = (1.0 if x * d[0] + y * d[1] + z * d[2] <= 0.0 else -1.0) / math.sqrt(x * x + y * y + z * z)
    flat = (scale * x, scale * y, scale * z)
    w, normals, uv = 1.0 - u - v, scene.normals[face], scene.uv[face]
    x = w * normals[0, 0] + u * normals[1, 0] + v * normals[2, 0]
    y = w * normals[0, 1] + u * normals[1, 1] + v * normals[2, 1]
    z = w * normals[0, 2] + u * normals[1, 2] + v * normals[2, 2]
    scale = (1.0 if scale > 0.0 else -1.0) / math.sqrt(max(x * x + y * y + z * z, 1e-300))
    left = w * uv[0, 0] + u * uv[1, 0] + v * uv[2, 0]
    down = w * uv[0, 1] + u * uv[1, 1] + v * uv[2, 1]
    if scene.pictures[face, 3] != 0:
        east, north = w * a[0] + u * b[0] + v * c[0], w * a[1] + u * b[1] + v * c[1]
        left += 0.5 + math.atan2(north, east) / (2.0 * math.pi)
        down += 0.5 + math.atan2(w * a[2] + u * b[2] + v * c[2], math.hypot(east, north)) / math.pi
    for k in range(3):
        albedo[k] = w * scene.albedo[face, 0, k] + u * scene.albedo[face, 1, k] + v * scene.albedo[face, 2, k]
        if scene.pictures[face, 1] > 0:
            albedo[k] *= _picture(scene, face, left, down, k)
    return (scale * x, scale * y, scale * z), flat


@inner
def sun_on(scene, normal, flat):
    """Cosine of the sun on a face, 0 where the face itself looks away."""
    sun = scene.lights[0]
    if flat[0] * sun[0] + flat[1] * sun[1] + flat[2] * sun[2] <= 0.0:
        return 0.0
    return max(normal[0] * sun[0] + normal[1] * sun[1] + normal[2] * sun[2], 0.0)


@inner
def face_light(scene, face, d, u, v, own, sunny):
    """What an opaque face sends towards the eye: always, and if the whole sun shone on it, (3,) each."""
    normal, flat = face_at(scene, face, d, u, v, own)
    facing = sun_on(scene, normal, flat)
    for k in range(3):
        sunny[k] = 0.0
        if scene.kinds[1] == UNLIT:
            own[k] *= scene.numbers[1]
        else:
            sunny[k] = own[k] / math.pi * facing * scene.lights[1, k]
            own[k] *= 0.5 * (1.0 + normal[2]) * scene.lights[2, k] / math.pi


@inner
def gather(begin, end, depth, bright, quantum, strata, state):
    """Gather an even stretch's brightness, were the sun seen freely, into strata of `quantum`.

    Args:
        bright: (3,) W m-2 sr-1 of the stretch.
        strata: how many there are (1,), the last being gathered; and of each the mean brightness, the distance of the
            place drawn in it, the brightness of each channel there over that of their mean, and that of each channel in
            all (N, 8).
    """
    count, of = strata
    mean = (bright[0] + bright[1] + bright[2]) / 3.0
    if mean <= 0.0:
        return
    hidden = -math.expm1(-depth)
    done = 0.0
    while done < 1.0:
        stratum = of[count[0]]
        part = 1.0 - done
        # where there is no room for another, the last takes the rest
        if count[0] < STRATA - 1:
            part = min(part, max((quantum - stratum[0]) / mean, 1e-12))
        stratum[0] += part * mean
        for c in range(3):
            stratum[5 + c] += part * bright[c]
        if uniform(state) * stratum[0] < part * mean:
            drawn = -math.log1p(-hidden * (done + part * uniform(state)))
            stratum[1] = begin + (end - begin) * min(drawn / depth, 1.0)
            for c in range(3):
                stratum[2 + c] = bright[c] / mean
        done += part
        if stratum[0] >= quantum * (1.0 - 1e-9) and count[0] < STRATA - 1:
            count[0] += 1
            of[count[0], :] = 0.0


@inner
def add_sunlight(scene, o, d, strata, last, light, work, stack, found):
    """Send each stratum's ray to the sun; returns the variance of what they bring, of the mean over the channels.

    Args:
        strata: as `_sunlit` has them, but the last is an opaque face, where it is bright. last: (1,) the share of the
            sun that the ray beside saw first, -1 for none; it gets this ray's. light: (3,) gets the radiance.
    """
    count, of = strata
    variance, first, before = 0.0, -1.0, 0.0
    for n in range(count[0] + 2):
        bright, t = of[n, 0], of[n, 1]
        if bright <= 0.0:
            continue
        share = 1.0
        if scene.kinds[4] != 0:
            share = sunlight(scene, (o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]), work, stack, found)
        # the share before stands for this one's but in what they differ by: where it is even, hues have no noise
        guess = before if n > 0 else last[0] if last[0] >= 0.0 else share
        for c in range(3):
            light[c] += of[n, 5 + c] * guess + bright * of[n, 2 + c] * (share - guess)
        if n == 0:
            first, variance = share, 0.5 * (bright * (share - last[0])) ** 2 if last[0] >= 0.0 else 0.0
        elif n <= count[0]:
            # neighbouring strata stand in for repeated draws of the same one; a lone one takes the ray beside
            change = 0.5 * (share - before) ** 2
            variance = bright**2 * change + (variance if n > 1 else of[0, 0] ** 2 * change)
        before = share
    if first >= 0.0:
        last[0] = first
    return variance


@inner
def scratch():
    """Arrays that a way through one tetrahedron needs."""
    return np.zeros(3), np.zeros(3), np.zeros(3, np.int64), np.zeros(3), np.zeros(8)
