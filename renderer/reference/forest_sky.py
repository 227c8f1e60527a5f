"""Exact light of the sky on leaves and ground of the forest reference: rays to the sky through the trees and the land.

The sky's radiance is a table over the upper hemisphere, constant over cells of one solid angle: rows of equal steps in
the sine of the elevation from the horizon up, columns of equal steps in azimuth, clockwise from north. A direction is
drawn with the table's own brightness as density, and weighs what its leaf or ground makes of it. Matter is drawn by
strata of equal light from a sky that nothing hides. Both estimates are unbiased for any number of rays. Over the
positions in a pixel the directions follow the sequence R2 (Roberts 2018), which lessens the noise further than the
stated variance knows.
"""

from __future__ import annotations

import math

from numba import njit

from renderer.reference.forest_leaves import is_wood, leaves, pick, uniform
from renderer.reference.forest_lookup import foot, ground_normal, tint, voxel_at
from renderer.reference.forest_march import ALL, GROUND, OPAQUE, SOLID, TK, TU, TV, ZERO, S, march

STEP_U, STEP_V = 0.7548776662466927, 0.5698402909980532
"""Steps of the sequence R2: powers of the inverse plastic number."""

DRAWS = 1 << 24
"""First number of this file's random draws: far from those of the sun."""

PER_RAY = 3
"""Random draws a ray: its matter, and the two turns of the sequence."""


@njit(cache=True, nogil=True)
def _entry(shares, u):
    """The entry of rising shares in which u in [0, 1) lies, and how far into it, 0 to 1."""
    low, high = 0, shares.shape[0] - 1
    while low < high:
        middle = (low + high) // 2
        if shares[middle] > u:
            high = middle
        else:
            low = middle + 1
    before = shares[low - 1] if low > 0 else 0.0
    return low, min(max((u - before) / max(shares[low] - before, 1e-300), 0.0), 1.0)


@njit(cache=True, nogil=True)
def sky_ray(scene, u, v):
    """A direction to the sky by two numbers in [0, 1), and each channel's radiance over its density, W m-2."""
    row, into_row = _entry(scene.sky_rows, u)
    column, into_column = _entry(scene.sky_columns[row], v)
    rows, columns = scene.sky_columns.shape
    up = (row + into_row) / rows
    azimuth = 2.0 * math.pi * (column + into_column) / columns
    level = math.sqrt(max(1.0 - up * up, 0.0))
    colour = scene.sky[row, column]
    scale = 3.0 * scene.sky_power / (colour[0] + colour[1] + colour[2])
    ray = (level * math.sin(azimuth), level * math.cos(azimuth), up)
    return ray, (colour[0] * scale, colour[1] * scale, colour[2] * scale)


@njit(cache=True, nogil=True)
def _drawn(scene, seed, pixel, sample, number):
    """The direction of one ray: within a pixel the samples of one number share a sequence, turned at random."""
    u = uniform(seed, pixel - sample, DRAWS + PER_RAY * number) + sample * STEP_U
    v = uniform(seed, pixel - sample, DRAWS + PER_RAY * number + 1) + sample * STEP_V
    return sky_ray(scene, u - math.floor(u), v - math.floor(v))


@njit(cache=True, nogil=True)
def _through(scene, x, y, z, ray, limit, step, empty):
    """Share of the light that comes along a ray from the sky: everything that stands is in its way, and the land."""
    if ray[2] <= 0.0:
        return 0.0
    status, _, tau, _ = march(scene, (x, y, z), ray, 0.0, 0.0, limit, step, SOLID, ALL, (0.0, 0.0), empty)
    return 0.0 if status in (GROUND, OPAQUE) else math.exp(-tau)


@njit(cache=True, nogil=True)
def sky_on_canopy(scene, o, d, record, light, n, total_even, limit, step, quantum, chance, empty, voxel, total):
    """Add what n recorded steps make of the sky that they see.

    Args:
        light: [6] what each step would send under a sky that nothing hides, mean over the channels and weighed by what
            is seen of it, and [7] the same unweighed. total_even: sum of the former.
        quantum: of that light for each ray. chance: (seed, pixel, sample, rays before).

    Returns the variance of the mean over channels, and the number of rays.
    """
    seed, pixel, sample, before = chance
    if total_even <= 0.0 or scene.sky_power <= 0.0:
        return 0.0, 0
    strata = 2 * max(1, math.ceil(0.5 * total_even / quantum))
    part, e, passed, variance, last = total_even / strata, ZERO, light[0, 6], 0.0, 0.0
    to_eye = (-d[0], -d[1], -d[2])
    for k in range(strata):
        target = (k + uniform(seed, pixel, DRAWS + PER_RAY * (before + k) + 2)) * part
        e, passed = pick(light, 6, n, target, e, passed)
        ray, power = _drawn(scene, seed, pixel, sample, before + k)
        x, y, z = o[0] + d[0] * record[e, S], o[1] + d[1] * record[e, S], o[2] + d[2] * record[e, S]
        tu, tv, tk = record[e, TU], record[e, TV], record[e, TK]
        voxel_at(scene, x, y, tu, tv, tk, voxel)
        normal = (2.0 * voxel[4] - 1.0, 2.0 * voxel[5] - 1.0, 2.0 * voxel[6] - 1.0)
        reflected, let, _ = leaves(normal, to_eye, ray)
        foot_x, foot_y = foot(scene, x, y, tu, tv, tk, False)
        shade = (1.0 + scene.tint * tint(foot_x, foot_y)) / voxel[3]
        opaque = is_wood(scene, tu, tv, tk)
        weight = part / light[e, 7] * _through(scene, x, y, z, ray, limit, step, empty)
        mean = 0.0
        for c in range(3):
            albedo = voxel[c] * shade
            glow = 0.0 if opaque else min(scene.leaf_transmission[c] * albedo, max(1.0 - albedo, 0.0))
            value = weight * power[c] * (albedo * reflected + glow * let)
            total[c] += value
            mean += value / 3.0
        if k % 2:
            variance += (mean - last) ** 2
        last = mean
    return variance, strata


@njit(cache=True, nogil=True)
def sky_on_ground(scene, x, y, z, soil, limit, step, quantum, chance, empty, total):
    """Add what bare ground makes of the sky that it sees.

    Args:
        soil: its albedo by channel, times the share of it that is seen. quantum, chance: as of the canopy.

    Returns the variance of the mean over channels.
    """
    seed, pixel, sample, before = chance
    nx, ny, nz = ground_normal(scene, x, y)
    even = 0.0
    for c in range(3):
        even += soil[c] * scene.e_sky[c] / (3.0 * math.pi)
    if even <= 0.0 or scene.sky_power <= 0.0:
        return 0.0
    rays = 2 * max(1, math.ceil(0.5 * even / quantum))
    variance, last = 0.0, 0.0
    for k in range(rays):
        ray, power = _drawn(scene, seed, pixel, sample, before + k)
        facing = nx * ray[0] + ny * ray[1] + nz * ray[2]
        weight = 0.0
        if facing > 0.0:
            weight = facing / (math.pi * rays) * _through(scene, x, y, z, ray, limit, step, empty)
        mean = 0.0
        for c in range(3):
            value = weight * soil[c] * power[c]
            total[c] += value
            mean += value / 3.0
        if k % 2:
            variance += (mean - last) ** 2
        last = mean
    return variance
