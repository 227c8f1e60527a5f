"""The clear air along a straight line: its optical depth, and a place where it scatters. Compiled; float64."""

from __future__ import annotations

import math

from numba import njit

from renderer.reference.clouds_layer import altitude, shell
from renderer.reference.clouds_world import AIR_TOP, OZONE_AT, RAYLEIGH_AT
from renderer.world.atmosphere import MIE_ASYMMETRY, MIE_HEIGHT, OZONE_HEIGHT, OZONE_SPREAD, RAYLEIGH_HEIGHT

STEPS = 40
"""Most steps along a line."""

POWER = 2.5
"""Steps lie close where a line is lowest."""

G = MIE_ASYMMETRY


@njit(cache=True, inline="always")
def _densities(high):
    height = max(high, 0.0) * 1e-3
    ozone = max(0.0, 1.0 - abs(height - OZONE_HEIGHT) / OZONE_SPREAD)
    return math.exp(-height / RAYLEIGH_HEIGHT), math.exp(-height / MIE_HEIGHT), ozone


@njit(cache=True)
def march(scene, p, d, end, way, depth, weight):
    """Cut a line through the air into steps.

    Args:
        p, d, end: the line, m; `end` may be FAR.
        way: (STEPS + 1,) gets the steps' ends. depth: (STEPS + 1, 3) the optical depth up to each. weight: (STEPS,)
            how much light each step scatters towards the line's beginning, in the mean over the bands.

    Returns:
        how many steps there are.
    """
    first, last, _, fourth = shell(scene, p, d, -1e4, AIR_TOP)
    last = min(fourth if fourth > 0.0 else last, end)
    if last <= first:
        return 0
    up = p[2] + scene.radius
    along = p[0] * d[0] + p[1] * d[1] + up * d[2]
    lowest = min(max(-along, first), last)
    length = last - first
    count = 4 if length < 2e3 else 10 if length < 2e4 else 20 if length < 8e4 else STEPS
    before, behind = (lowest - first) ** (1.0 / POWER), (last - lowest) ** (1.0 / POWER)
    way[0] = first
    for c in range(3):
        depth[0, c] = 0.0
    for k in range(count):
        if length < 2e4:
            way[k + 1] = first + length * (k + 1) / count
        else:
            s = -before + (before + behind) * (k + 1) / count
            way[k + 1] = lowest + math.copysign(abs(s) ** POWER, s)
        t, step = 0.5 * (way[k] + way[k + 1]), way[k + 1] - way[k]
        molecules, haze, ozone = _densities(altitude(scene, p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2]))
        sent = 0.0
        for c in range(3):
            lost = (
                scene.triples[RAYLEIGH_AT, c] * molecules + scene.mie_lost * haze + scene.triples[OZONE_AT, c] * ozone
            )
            depth[k + 1, c] = depth[k, c] + lost * step
            sent += (scene.triples[RAYLEIGH_AT, c] * molecules + scene.mie * haze) * math.exp(
                -0.5 * (depth[k, c] + depth[k + 1, c])
            )
        weight[k] = sent / 3.0 * step
    return count


@njit(cache=True)
def scatter_place(scene, p, d, count, way, depth, weight, u, v, factor):
    """Draw where a line scatters, and whether molecules or haze do it.

    Args:
        count, way, depth, weight: of `march`. u, v: in [0, 1).
        factor: (3,) gets what the light scattered there counts for in each band, [1] over the phase function.

    Returns:
        the distance, m, and whether it is haze; a negative distance where nothing scatters.
    """
    total = 0.0
    for k in range(count):
        total += weight[k]
    if total <= 0.0:
        return -1.0, False
    left, k = u * total, 0
    while k < count - 1 and left >= weight[k]:
        left -= weight[k]
        k += 1
    share = min(max(left / max(weight[k], 1e-300), 0.0), 1.0)
    step = way[k + 1] - way[k]
    t = way[k] + share * step
    molecules, haze, _ = _densities(altitude(scene, p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2]))
    light = (
        (scene.triples[RAYLEIGH_AT, 0] + scene.triples[RAYLEIGH_AT, 1] + scene.triples[RAYLEIGH_AT, 2])
        / 3.0
        * molecules
    )
    chance = light / max(light + scene.mie * haze, 1e-300)
    is_haze = v >= chance
    for c in range(3):
        sent = scene.mie * haze / (1.0 - chance) if is_haze else scene.triples[RAYLEIGH_AT, c] * molecules / chance
        passed = depth[k, c] + share * (depth[k + 1, c] - depth[k, c])
        factor[c] = sent * math.exp(-passed) * step * total / max(weight[k], 1e-300)
    return t, is_haze


@njit(cache=True, inline="always")
def air_phase(is_haze, cosine):
    """Phase function of haze (Cornette and Shanks 1992) or molecules, 1/sr."""
    if is_haze:
        scale = 3.0 / (8.0 * math.pi) * (1.0 - G * G) / (2.0 + G * G)
        return scale * (1.0 + cosine * cosine) / (1.0 + G * G - 2.0 * G * cosine) ** 1.5
    return 3.0 / (16.0 * math.pi) * (1.0 + cosine * cosine)


@njit(cache=True)
def air_cosine(is_haze, u):
    """A cosine to scatter by, and what it counts for: from Henyey and Greenstein's lobe for haze, evenly else."""
    if is_haze:
        s = (1.0 - G * G) / (1.0 - G + 2.0 * G * u)
        cosine = (1.0 + G * G - s * s) / (2.0 * G)
        return cosine, 1.5 * (1.0 + cosine * cosine) / (2.0 + G * G)
    cosine = 2.0 * u - 1.0
    return cosine, 0.75 * (1.0 + cosine * cosine)


@njit(cache=True)
def depth_to_top(scene, x, y, z, d, out):
    """Optical depth of the air from a point along a direction that meets no ground, (3,)."""
    up = z + scene.radius
    r = math.sqrt(x * x + y * y + up * up)
    along = x * d[0] + y * d[1] + up * d[2]
    rest = (r - scene.radius) * (r + scene.radius)
    widest = math.sqrt(AIR_TOP * (2.0 * scene.radius + AIR_TOP))
    if r >= scene.radius + AIR_TOP:
        # from space: the line enters the air where it meets its top, if it does
        over = along * along - rest + widest * widest
        if along >= 0.0 or over <= 0.0:
            out[0] = out[1] = out[2] = 0.0
            return
        t = -along - math.sqrt(over)
        r, rest = scene.radius + AIR_TOP, widest * widest
        along = along + t
    rho = math.sqrt(max(rest, 0.0))
    nearest = scene.radius + AIR_TOP - r
    length = -along + math.sqrt(max(along * along - rest + widest * widest, 0.0))
    rows, columns = scene.depths.shape[0], scene.depths.shape[1]
    row = min(rho / widest * (rows - 1), rows - 1.000001)
    column = (length - nearest) / max(rho + widest - nearest, 1e-6) * (columns - 1)
    column = min(max(column, 0.0), columns - 1.000001)
    i, j = int(row), int(column)
    v, u = row - i, column - j
    for c in range(3):
        one = scene.depths[i, j, c] + u * (scene.depths[i, j + 1, c] - scene.depths[i, j, c])
        two = scene.depths[i + 1, j, c] + u * (scene.depths[i + 1, j + 1, c] - scene.depths[i + 1, j, c])
        out[c] = one + v * (two - one)
