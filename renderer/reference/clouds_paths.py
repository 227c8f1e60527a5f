"""Paths of light through the clouds' reference, from the eye on. Compiled; float64.

A path goes straight to the next droplet that scatters it, to the ground or into space. What the air on its way
scatters is drawn besides: always on the path's first stretch, later by chance. The sun is looked for wherever
something scatters (`clouds_sun`); what sunlight has only been bent by the droplets' forward peak on its way is found
there, and nowhere else.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from renderer.reference.clouds_air import STEPS, air_cosine, march, scatter_place
from renderer.reference.clouds_layer import FAR, LIFT, altitude, ground_at, ground_of, run, sphere_at
from renderer.reference.clouds_phase import PEAK_OF, PEAK_SUM, REST_OF, REST_SUM, draw_cosine, place_of, read
from renderer.reference.clouds_sun import CLOUD, GROUND, HAZE, MOLECULES, MOST, peak_light, sunlight, turned, uniform
from renderer.reference.clouds_world import SHARE

NEAR = 200.0
"""Ways shorter than this are taken to be free of air, m: it scatters a thousandth of what the clouds do."""

WIDE = 2e4
"""A way that meets no cloud before this may meet land that its beginning stands above, m."""

WHOLE, BROKEN = np.bool_(True), np.bool_(False)
"""Whether a path has met the droplets' peak alone; numpy's, since for each literal of Python all would be compiled."""

LONG, GOES_ON = 150, 0.98
"""Events after which a path ends by chance, and the chance that it goes on."""

SHARES = (0.7548776662466927, 0.5698402909980532, 0.4301597090019468, 0.8191725133961645, 0.6710436067037893)
"""Steps of the low-discrepancy sequences that a position's paths begin with: place, place, first droplet, first
scattering in the air, hero band (Roberts 2018)."""


@njit(cache=True)
def _space(scene, factor, path, out):
    """Add what comes from space, where anything does."""
    if scene.space > 0.0:
        mean = (path[0] + path[1] + path[2]) / 3.0
        for c in range(3):
            out[c] += scene.space * factor[c] * path[c] / mean


@njit(cache=True)
def _droplet(scene, hero, p, d, whole, factor, path, state, work, out):
    """Scatter at a droplet: the new direction, and whether only the peak has been met so far."""
    tables, shares = scene.tables, scene.triples[SHARE]
    if whole:
        peak_light(scene, p, d, factor, path, state, work, out)
    peak = uniform(state) < shares[hero]
    if peak:
        cosine = draw_cosine(tables, scene.guides, PEAK_SUM + hero, uniform(state))
    else:
        # the chance of being here is in the path's density, and the phase function's share in what is sent
        for c in range(3):
            path[c] *= (1.0 - shares[c]) / (1.0 - shares[hero])
            factor[c] /= 1.0 - shares[c]
        sunlight(scene, hero, p, d, CLOUD, factor, path, state, work, out)
        for c in range(3):
            path[c] *= (1.0 - shares[hero]) / (1.0 - shares[c])
            factor[c] *= 1.0 - shares[c]
        cosine = draw_cosine(tables, scene.guides, REST_SUM + hero, uniform(state))
    place = place_of(math.acos(min(max(cosine, -1.0), 1.0)))
    row = PEAK_OF if peak else REST_OF
    own = max(read(tables, row + hero, place), 1e-12)
    for c in range(3):
        path[c] *= read(tables, row + c, place) / own
    return turned(d, cosine, 2.0 * math.pi * uniform(state)), whole and peak


@njit(cache=True)
def _air(scene, hero, p, d, count, u, factor, path, state, work, marched, sent, out):
    """Scatter a path in the air of its way: where, where to, and what it then counts for, in `sent`.

    Args:
        count: steps of the way, as `marched` has them. u: in [0, 1), the share of its scattering before the place.
    """
    way, depth, weight = marched
    t, is_haze = scatter_place(scene, p, d, count, way, depth, weight, u, uniform(state), sent)
    if t < 0.0:
        return False, p, d
    for c in range(3):
        sent[c] *= factor[c]
    x = (p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2])
    sunlight(scene, hero, x, d, HAZE if is_haze else MOLECULES, sent, path, state, work, out)
    cosine, counts = air_cosine(is_haze, uniform(state))
    for c in range(3):
        sent[c] *= counts
    return True, x, turned(d, cosine, 2.0 * math.pi * uniform(state))


@njit(cache=True)
def _first_air(scene, hero, p, d, count, factor, path, state, work, marched, sent, what, out):
    """Let the air of a first stretch scatter and absorb: a path from a place of it is kept in `what`. Returns the
    share that comes through, by luminance."""
    more, x, turn = _air(scene, hero, p, d, count, what[3], factor, path, state, work, marched, sent, out)
    if more:
        what[7], what[8], what[9] = x
        what[10], what[11], what[12] = turn
        what[13] = 1.0
    kept = 0.0
    for c in range(3):
        what[4 + c] = sent[c]
        through = math.exp(-marched[1][count, c])
        factor[c] *= through
        kept += through * (0.2126 if c == 0 else 0.7152 if c == 1 else 0.0722)
    return kept


@njit(cache=True)
def _later_air(scene, hero, p, d, count, factor, path, state, work, marched, sent, out):
    """Let the air of a later stretch scatter a path by chance, or absorb some of it.

    Returns:
        0 where it comes through, 1 where it goes on from the place and in the direction that follow, 2 where it ends.
    """
    through = 0.0
    for c in range(3):
        through += math.exp(-marched[1][count, c]) / 3.0
    if uniform(state) < through:
        for c in range(3):
            factor[c] *= math.exp(-marched[1][count, c]) / through
        return 0, p, d
    for c in range(3):
        factor[c] /= 1.0 - through
    more, p, d = _air(scene, hero, p, d, count, uniform(state), factor, path, state, work, marched, sent, out)
    light = max(sent[0], sent[1], sent[2])
    chance = max(min(10.0 * light, 1.0), 0.05)
    if not more or uniform(state) >= chance:
        return 2, p, d
    for c in range(3):
        factor[c] = sent[c] / chance
    return 1, p, d


@njit(cache=True)
def _ground(scene, hero, p, factor, path, state, work, spare, out):
    """Scatter a path at the ground: whether it goes on, and from where, and where to."""
    normal, albedo = spare[0], spare[1]
    ground_of(scene, p[0], p[1], p[2], normal, albedo)
    n = (normal[0], normal[1], normal[2])
    p = (p[0] + LIFT * n[0], p[1] + LIFT * n[1], p[2] + LIFT * n[2])
    for c in range(3):
        factor[c] *= albedo[c]
    sunlight(scene, hero, p, n, GROUND, factor, path, state, work, out)
    chance = min(max(albedo[0], albedo[1], albedo[2], 0.02), 1.0)
    for c in range(3):
        factor[c] /= chance
    d = turned(n, math.sqrt(uniform(state)), 2.0 * math.pi * uniform(state))
    return uniform(state) < chance, p, d


@njit(cache=True)
def _follow(scene, hero, p, d, u, whole, factor, path, state, work, marched, spare, what, out):
    """Follow a path to its end.

    Args:
        p, d: where it begins. u: chance that its first stretch passes more cloud than it does; -1 for any.
        whole: whether it may meet the sun by the droplets' peak alone.
        factor, path: as of `sunlight`; they are changed. spare: (3, 3) scratch.
        what: (14,) gets 1 where the first stretch ends: space, cloud or ground; nothing where u is -1. Then comes where
            in the air of that stretch a second path begins; gets what that counts for, its beginning and direction,
            and whether there is one.
        out: (3,) gets the radiance.

    Returns:
        how much of the light behind the first stretch comes through its air, by luminance.
    """
    kept, first = 1.0, u >= 0.0
    for event in range(100000):
        free = -math.log(1.0 - (u if first else uniform(state))) / scene.extinction
        # above all land, the land is only looked for where the clouds end
        high = min(altitude(scene, p[0], p[1], p[2]), scene.base) > scene.land_top
        stop = sphere_at(scene, p, d) if high else ground_at(scene, p, d)
        t = run(scene, p, d, free, stop, uniform(state))[1]
        if high and t > WIDE:
            stop = ground_at(scene, p, d)
        end = min(t, stop)
        count = march(scene, p, d, end, marched[0], marched[1], marched[2]) if end > NEAR else 0
        if count > 0 and first:
            kept = _first_air(scene, hero, p, d, count, factor, path, state, work, marched, spare[2], what, out)
        elif count > 0:
            then, p, d = _later_air(scene, hero, p, d, count, factor, path, state, work, marched, spare[2], out)
            if then == 2:
                return kept
            if then == 1:
                whole = BROKEN
                continue
        if first:
            what[0 if end >= FAR else 1 if t < stop else 2] = 1.0
            first = False
        if end >= FAR:
            _space(scene, factor, path, out)
            return kept
        p = (p[0] + end * d[0], p[1] + end * d[1], p[2] + end * d[2])
        if t < stop:
            d, whole = _droplet(scene, hero, p, d, whole, factor, path, state, work, out)
        else:
            goes_on, p, d = _ground(scene, hero, p, factor, path, state, work, spare, out)
            if not goes_on:
                return kept
            whole = BROKEN
        if event > LONG:
            if uniform(state) >= GOES_ON:
                return kept
            for c in range(3):
                factor[c] /= GOES_ON
    return kept


@njit(cache=True)
def _ray(rays, row, column, jitter, out):
    """A ray of a pixel, moved by a part of its width and height: its beginning and unit direction, (6,)."""
    length = 0.0
    for c in range(6):
        of, k = (0, c) if c < 3 else (1, c - 3)
        out[c] = (
            rays[of, 0, row, column, k]
            + jitter[0] * rays[of, 1, row, column, k]
            + jitter[1] * rays[of, 2, row, column, k]
        )
        length += out[c] * out[c] if of == 1 else 0.0
    for c in range(3, 6):
        out[c] /= math.sqrt(length)


@njit(cache=True)
def _sample(scene, start, u, state, work, marched, spare, sums, first, light):
    """Follow one path from a pixel, and the one that begins in the air of its first stretch.

    Args:
        start: of `_ray`. u: (5,) where the low-discrepancy sequences are.
        sums: (2, 3) scratch. first: (14,) as `what` of `_follow`. light: (3,) gets the radiance.

    Returns:
        the opacity.
    """
    factor, path = sums[0], sums[1]
    hero = min(int(3.0 * u[4]), 2)
    factor[:] = 1.0
    path[:] = 1.0
    light[:] = 0.0
    first[:] = 0.0
    first[3] = u[3]
    p, d = (start[0], start[1], start[2]), (start[3], start[4], start[5])
    kept = _follow(scene, hero, p, d, u[2], WHOLE, factor, path, state, work, marched, spare, first, light)
    if first[13] > 0.0:
        for c in range(3):
            factor[c], path[c] = first[4 + c], 1.0
        p, d = (first[7], first[8], first[9]), (first[10], first[11], first[12])
        _follow(scene, hero, p, d, -1.0, BROKEN, factor, path, state, work, marched, spare, first, light)
    return 1.0 if first[0] == 0.0 else 1.0 - kept


@njit(cache=True, nogil=True)
def rows(scene, rays, begin, end, paths, seed, number, total, variance, what):
    """Follow the paths of one position of some rows of the picture.

    Args:
        rays: (2, 3, H, W, 3), beginnings and directions: of the position, and how they change by a pixel to the right
            and down.
        begin, end: rows. paths: of each pixel, from a square of a quarter of its side round the position.
        seed, number: of the sequence, of the position.
        total: (H, W, 4) gets the mean radiance and the opacity. variance: (H, W) that of the mean over the channels.
        what: (H, W, 3) gets how much of it is space, cloud, ground.
    """
    state = np.zeros(1, np.uint64)
    work = (np.zeros((MOST, 3)), np.zeros(MOST), np.zeros(3), np.zeros(3), np.zeros(3))
    marched = (np.zeros(STEPS + 1), np.zeros((STEPS + 1, 3)), np.zeros(STEPS))
    spare, sums = np.zeros((3, 3)), np.zeros((2, 3))
    light, first, start, turns, u = np.zeros(3), np.zeros(14), np.zeros(6), np.zeros(5), np.zeros(5)
    for row in range(begin, end):
        for column in range(rays.shape[3]):
            state[0] = np.uint64(((seed * 1009 + number) * 65536 + row) * 65536 + column)
            uniform(state)
            for k in range(5):
                turns[k] = uniform(state)
            square, mean = 0.0, 0.0
            for ray in range(paths):
                for k in range(5):
                    u[k] = (turns[k] + ray * SHARES[k]) % 1.0
                _ray(rays, row, column, (0.25 * u[0] - 0.125, 0.25 * u[1] - 0.125), start)
                opaque = _sample(scene, start, u, state, work, marched, spare, sums, first, light)
                for c in range(3):
                    total[row, column, c] += light[c] / paths
                    what[row, column, c] += first[c] / paths
                total[row, column, 3] += opaque / paths
                one = (light[0] + light[1] + light[2]) / 3.0
                mean += one / paths
                square += one * one / paths
            variance[row, column] += max(square - mean * mean, 0.0) / max(paths - 1, 1)
