"""What a straight line meets on its way: the layer of clouds, the land, the sphere. Compiled; float64.

Points are from the site, the planet's centre at (0, 0, -R). Maps are read at a point's stereographic place,
bilinearly; the layer's upper side is found by steps of half a texel, and exactly where it is straight between two.
"""

from __future__ import annotations

import math

from numba import njit

from renderer.reference.clouds_world import ALBEDO, EAST, NORTH, POLE, ROCK, SNOW

FAR = 1e30
"""Farther than anything, m."""

GROWTH = 0.01
"""Steps grow to this share of the way from where a line begins."""

LIFT = 0.05
"""Height above the ground at which lines from it begin, m."""


@njit(cache=True, inline="always")
def altitude(scene, x, y, z):
    """Height of a point above the sphere, m."""
    up = z + scene.radius
    return math.sqrt(x * x + y * y + up * up) - scene.radius


@njit(cache=True, inline="always")
def _place(scene, x, y, z):
    """Stereographic place of a point, and its altitude."""
    up = z + scene.radius
    r = math.sqrt(x * x + y * y + up * up)
    scale = 2.0 * scene.radius / max(r + up, 1.0)
    return x * scale, y * scale, r - scene.radius


@njit(cache=True, inline="always")
def _periodic(table, row, column):
    """A periodic table at a place in periods, between its entries; its first row and column come again at its end."""
    rows, columns = table.shape[0] - 1, table.shape[1] - 1
    v, u = (row - math.floor(row)) * rows - 0.5, (column - math.floor(column)) * columns - 0.5
    v, u = v + rows if v < 0.0 else v, u + columns if u < 0.0 else u
    i, j = min(int(v), rows - 1), min(int(u), columns - 1)
    v, u = v - i, u - j
    first = table[i, j] + u * (table[i, j + 1] - table[i, j])
    second = table[i + 1, j] + u * (table[i + 1, j + 1] - table[i + 1, j])
    return first + v * (second - first)


@njit(cache=True, inline="always")
def _clamped(table, row, column):
    """A table at a place in shares of its sides, between its entries, as its edges beyond them; padded likewise."""
    rows, columns = table.shape[0] - 1, table.shape[1] - 1
    v, u = min(max(row * rows - 0.5, 0.0), rows - 1.0), min(max(column * columns - 0.5, 0.0), columns - 1.0)
    i, j = int(v), int(u)
    v, u = v - i, u - j
    first = table[i, j] + u * (table[i, j + 1] - table[i, j])
    second = table[i + 1, j] + u * (table[i + 1, j + 1] - table[i + 1, j])
    return first + v * (second - first)


@njit(cache=True, inline="always")
def gap_of(scene, shares, systems, x, y, z):
    """How far a point lies below the layer's upper side, m; negative above it. shares, systems: the scene's maps."""
    up = z + scene.radius
    r = math.sqrt(x * x + y * y + up * up)
    scale = 2.0 * scene.radius / max(r + up, 1.0)
    u = (x * scale - scene.drift_east) / scene.cloud_side
    v = (y * scale - scene.drift_north) / scene.cloud_side
    thickness = 0.0
    if scene.cloud_repeats or max(abs(u), abs(v)) < 0.5:
        thickness = scene.thickness * _periodic(shares, v + 0.5, u + 0.5)
        if systems.shape[0] > 2 and thickness > 0.0:
            # Lambert's projection of the whole sphere, -1 to 1
            flat = 0.5 / math.sqrt(2.0 * r * max(r + up, 1.0))
            thickness *= _clamped(systems, 0.5 + y * flat, 0.5 + x * flat)
    high = r - scene.radius - scene.base
    return thickness - high if thickness > 1e-3 else min(-high, -1e-3)


@njit(cache=True)
def gap_at(scene, p):
    """How far a point lies below the layer's upper side, m; negative above it."""
    return gap_of(scene, scene.cloud_map, scene.systems, p[0], p[1], p[2])


@njit(cache=True)
def shell(scene, p, d, low, high):
    """The two stretches of a line between two altitudes: begin and end of each, from 0 on; empty ones end at 0."""
    up = p[2] + scene.radius
    along = p[0] * d[0] + p[1] * d[1] + up * d[2]
    here = math.sqrt(p[0] * p[0] + p[1] * p[1] + up * up)
    outer, inner = scene.radius + high, scene.radius + low
    over = along * along - (here - outer) * (here + outer)
    if over <= 0.0:
        return 0.0, 0.0, 0.0, 0.0
    root = math.sqrt(over)
    first, last = max(-along - root, 0.0), -along + root
    if last <= 0.0:
        return 0.0, 0.0, 0.0, 0.0
    under = along * along - (here - inner) * (here + inner)
    if under <= 0.0:
        return first, last, 0.0, 0.0
    root = math.sqrt(under)
    down, rise = -along - root, -along + root
    if rise <= 0.0:
        return first, last, 0.0, 0.0
    return first, max(down, 0.0), rise, last


@njit(cache=True)
def run(scene, p, d, want, end, jitter):
    """Follow a line through the clouds until it has been inside them for a given length.

    Args:
        p, d: where it begins and its direction. want: length inside clouds, m. end: of the line, m. jitter: in [0, 1),
            of the first step.

    Returns:
        the length inside, at most `want`, and where it reached `want`; FAR where it did not.
    """
    first, second, third, fourth = shell(scene, p, d, scene.base, scene.top)
    inside, shares, systems = 0.0, scene.cloud_map, scene.systems
    # How fast the gap can change along the line at most, so that a wide one is crossed in one step.
    up = (p[2] + scene.radius) / (scene.radius + scene.base)
    rise = abs(p[0] / scene.radius * d[0] + p[1] / scene.radius * d[1] + up * d[2])
    change = scene.steepness * math.sqrt(max(1.0 - rise * rise, 0.0)) + rise + 0.02
    for half in range(2):
        a, b = (first, second) if half == 0 else (third, fourth)
        b = min(b, end)
        if b <= a:
            continue
        t = a
        gap = gap_of(scene, shares, systems, p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2])
        least = scene.step * (0.25 + 0.75 * jitter)
        while t < b:
            step = min(max(least, abs(gap) / change), b - t)
            if gap > 0.0:
                step = min(step, max(want - inside, 1e-6))
            far = t + step
            following = gap_of(scene, shares, systems, p[0] + far * d[0], p[1] + far * d[1], p[2] + far * d[2])
            enter, leave = 0.0, step
            if gap <= 0.0 and following <= 0.0:
                leave = 0.0
            elif gap <= 0.0:
                enter = step * gap / (gap - following)
            elif following <= 0.0:
                leave = step * gap / (gap - following)
            if inside + (leave - enter) >= want:
                return want, t + enter + (want - inside)
            inside += leave - enter
            t += step
            gap = following
            least = max(scene.step, GROWTH * t)
    return inside, FAR


@njit(cache=True)
def height_at(scene, x, y):
    """Height of the land at a place, and its rise to the east and to the north."""
    n = scene.height.shape[0]
    u, v = x / scene.land_cell + 0.5 * n - 0.5, y / scene.land_cell + 0.5 * n - 0.5
    if u < 0.0 or v < 0.0 or u >= n - 1 or v >= n - 1:
        return 0.0, 0.0, 0.0
    j, i = int(u), int(v)
    u, v = u - j, v - i
    a, b, c, d = scene.height[i, j], scene.height[i, j + 1], scene.height[i + 1, j], scene.height[i + 1, j + 1]
    east = ((b - a) + v * ((d - c) - (b - a))) / scene.land_cell
    north = ((c - a) + u * ((d - b) - (c - a))) / scene.land_cell
    return a + u * (b - a) + v * ((c - a) + u * ((d - c) - (b - a))), east, north


@njit(cache=True)
def sphere_at(scene, p, d):
    """Distance along a line to the sphere below the land, m; FAR where it meets none."""
    up = p[2] + scene.radius
    along = p[0] * d[0] + p[1] * d[1] + up * d[2]
    here = math.sqrt(p[0] * p[0] + p[1] * p[1] + up * up)
    under = along * along - (here - scene.radius) * (here + scene.radius)
    if along < 0.0 and under > 0.0:
        return max(-along - math.sqrt(under), 0.0)
    return FAR


@njit(cache=True)
def ground_at(scene, p, d):
    """Distance along a line to the ground, m; FAR where it meets none."""
    sphere = sphere_at(scene, p, d)
    if scene.land_top <= 0.0:
        return sphere
    along = p[0] * d[0] + p[1] * d[1] + (p[2] + scene.radius) * d[2]
    first, second, third, fourth = shell(scene, p, d, -100.0, scene.land_top)
    half = 0.5005 * scene.land_cell * scene.height.shape[0]
    enter, leave = 0.0, sphere
    for axis in range(2):
        if abs(d[axis]) > 1e-12:
            one, two = (-half - p[axis]) / d[axis], (half - p[axis]) / d[axis]
            enter, leave = max(enter, min(one, two)), min(leave, max(one, two))
        elif abs(p[axis]) > half:
            leave = -1.0
    for part in range(2):
        a, b = (first, second) if part == 0 else (third, fourth)
        a, b = max(a, enter), min(b, leave)
        before, gap_before, t = a, 1.0, a
        while t < b:
            x, y, high = _place(scene, p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2])
            gap = high - height_at(scene, x, y)[0]
            if gap <= 0.0:
                if t == a:
                    return t
                return before + (t - before) * gap_before / (gap_before - gap)
            before, gap_before = t, gap
            descent = -(along + t) / (scene.radius + high)
            t += max(gap / max(scene.land_steepness + descent, 0.02), 0.2 * scene.land_cell)
    return sphere


@njit(cache=True)
def ground_of(scene, x, y, z, normal, albedo):
    """The ground's unit normal and albedo at a point of it."""
    east, north, high = _place(scene, x, y, z)
    rise = height_at(scene, east, north)
    r = scene.radius + high
    up = (x / r, y / r, (z + scene.radius) / r)
    length = 0.0
    for k in range(3):
        normal[k] = up[k] - (rise[1] if k == 0 else rise[2] if k == 1 else 0.0)
        length += normal[k] * normal[k]
    for k in range(3):
        normal[k] /= math.sqrt(length)
    of = scene.triples
    ex = of[EAST, 0] * up[0] + of[EAST, 1] * up[1] + of[EAST, 2] * up[2]
    ey = of[NORTH, 0] * up[0] + of[NORTH, 1] * up[1] + of[NORTH, 2] * up[2]
    ez = of[POLE, 0] * up[0] + of[POLE, 1] * up[1] + of[POLE, 2] * up[2]
    rows, columns = scene.globe.shape[0], scene.globe.shape[1]
    row = min(max((math.asin(min(max(ez, -1.0), 1.0)) / math.pi + 0.5) * rows - 0.5, 0.0), rows - 1.001)
    column = (math.atan2(ey, ex) / (2.0 * math.pi) + 0.5) * columns - 0.5
    low, left = int(row), math.floor(column)
    v, u = row - low, column - left
    site = 1.0 - _smooth((math.hypot(east, north) / scene.site_size - 0.8) / 0.4)
    snow = _smooth((high - scene.snow_line + 60.0) / 120.0)
    half = 0.5 * scene.land_cell * scene.height.shape[0]
    level = normal[0] * up[0] + normal[1] * up[1] + normal[2] * up[2]
    rock = 1.0 - _smooth((level - scene.holds + 0.06) / 0.12)
    rock = rock if max(abs(east), abs(north)) < half else 0.0
    for c in range(3):
        one = (1 - u) * scene.globe[low, left % columns, c] + u * scene.globe[low, (left + 1) % columns, c]
        two = (1 - u) * scene.globe[low + 1, left % columns, c] + u * scene.globe[low + 1, (left + 1) % columns, c]
        near = of[ALBEDO, c] + snow * (of[SNOW, c] - of[ALBEDO, c])
        far = one + v * (two - one)
        albedo[c] = far + site * (near - far)
        albedo[c] += rock * (of[ROCK, c] - albedo[c])


@njit(cache=True, inline="always")
def _smooth(t):
    t = min(max(t, 0.0), 1.0)
    return t * t * (3.0 - 2.0 * t)
