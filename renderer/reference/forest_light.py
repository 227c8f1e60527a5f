"""What a ray of the forest reference carries: light scattered at each step, with exact visibility of the sun.

Radiance leaving matter: E_sun V f and what it makes of the sky, f its leaves' answer (`forest_leaves.leaves`). Steps
along the view ray are all integrated; only the sun's visibility V, which costs a march of its own, is sampled: by
strata of equal unshadowed sunlight, one jittered shadow ray each. The estimate is unbiased for any number of strata,
and its mean over the channels is exact where nothing is shadowed. The sky is exact by rays to it (`forest_sky`), or
E_sky a g / pi: a the pattern's own share of it, g the leaves' answer to an even sky.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from renderer.reference.forest_leaves import is_wood, leaves, pick, uniform
from renderer.reference.forest_lookup import bilinear, foot, ground_normal, kept, patches, texel, tint, voxel_at
from renderer.reference.forest_march import (
    ALL,
    COLUMNS,
    DS,
    FULL,
    GROUND,
    NONE,
    NOT_OWN,
    ONLY_OWN,
    OPAQUE,
    SIGMA,
    SOLID,
    TK,
    TU,
    TV,
    ZERO,
    S,
    march,
)
from renderer.reference.forest_sky import sky_on_canopy, sky_on_ground

NOMINAL_ALBEDO = 0.1
"""Albedo of a leaf (linear, mean over channels) that the number of strata refers to: brighter matter gets more rays."""

DEPTH_LIMIT = 9.2
"""Optical depth after which a march stops: a ten-thousandth of the light is left, and takes the colour of the rest."""

LIFT = 1e-3
"""Metres above the ground at which its shadow rays start, so that rounding does not make a facet shade itself."""

TERRAIN, FOREST_ON_GROUND, TREE_ON_TREE, WITHIN_TREE, LIGHT, HEMISPHERE = range(6)
"""Switches of one rendering, in the order the compiled functions read them."""

LEAF, LAMBERT, GOURAUD = range(3)
"""Values of the switch LIGHT."""


@njit(cache=True, nogil=True)
def visibility(scene, switches, x, y, z, step, mode, own, empty):
    """Share of the sun's beam that reaches a point: exp(-integral of extinction), 0 where the ground is in the way."""
    sun = (scene.sun[0], scene.sun[1], scene.sun[2])
    if sun[2] <= 0.0 and switches[TERRAIN]:
        # the ground continues without end: a ray that does not rise meets it
        return 0.0
    if mode == NONE and not switches[TERRAIN]:
        return 1.0
    status, _, tau, _ = march(scene, (x, y, z), sun, 0.0, 0.0, DEPTH_LIMIT, step, switches[TERRAIN] != 0, mode, own,
                           empty)
    return 0.0 if status in (GROUND, OPAQUE) else math.exp(-tau)


@njit(cache=True, nogil=True)
def _canopy_light(scene, switches, x, y, to_eye, event, voxel, out):
    """Unshadowed radiance that matter at a recorded step scatters: out[0:3] from the sky, out[3:6] from the sun.

    `voxel` holds what stands there afterwards; of an even sky nothing is hidden yet.
    """
    tu, tv, tk = event[TU], event[TV], event[TK]
    voxel_at(scene, x, y, tu, tv, tk, voxel)
    sun = (scene.sun[0], scene.sun[1], scene.sun[2])
    normal = (2.0 * voxel[4] - 1.0, 2.0 * voxel[5] - 1.0, 2.0 * voxel[6] - 1.0)
    reflected, passed, upwards = leaves(normal, to_eye, sun)
    if switches[LIGHT] != LEAF:
        nx, ny, nz = ground_normal(scene, x, y) if switches[LIGHT] == GOURAUD else normal
        length = math.sqrt(nx * nx + ny * ny + nz * nz)
        facing = (nx * sun[0] + ny * sun[1] + nz * sun[2]) / length if length > 0.0 else 0.0
        reflected, passed = max(facing, 0.0) / math.pi, 0.0
    foot_x, foot_y = foot(scene, x, y, tu, tv, tk, False)
    shade = (1.0 + scene.tint * tint(foot_x, foot_y)) / voxel[3]
    opaque = is_wood(scene, tu, tv, tk)
    for c in range(3):
        albedo = voxel[c] * shade
        through = 0.0 if opaque else min(scene.leaf_transmission[c] * albedo, max(1.0 - albedo, 0.0))
        evenly = 0.5 * (albedo + through + upwards * (albedo - through))
        out[c] = evenly * scene.e_sky[c] / math.pi
        out[3 + c] = (albedo * reflected + through * passed) * scene.e_sun[c]


@njit(cache=True, nogil=True)
def _ground_light(scene, switches, x, y, z, step, quantum, chance, empty, share, voxel, total):
    """Add the light that bare ground sends up, times `share`, and its opacity. Returns the variance of the mean."""
    share *= kept(scene, x, y)
    total[3] += share
    soil = 1.0 + scene.patches * patches(x, y)
    nx, ny, nz = ground_normal(scene, x, y)
    ambient = 0.0 if switches[HEMISPHERE] else 1.0
    if not switches[HEMISPHERE] and bilinear(scene.cover, scene.cell, x, y) > 0.5:
        tu, tv = texel(scene, x, y)
        voxel_at(scene, x, y, tu, tv, 0.0, voxel)
        ambient = voxel[7]
    ambient *= 0.5 * (1.0 + nz)
    facing = max(nx * scene.sun[0] + ny * scene.sun[1] + nz * scene.sun[2], 0.0)
    seen = 0.0
    if facing > 0.0:
        mode = ALL if switches[FOREST_ON_GROUND] else NONE
        seen = visibility(scene, switches, x, y, z + LIFT, step, mode, (0.0, 0.0), empty)
    for c in range(3):
        light = scene.e_sun[c] * facing * seen + scene.e_sky[c] * ambient
        voxel[c] = share * scene.ground[c] * soil
        total[c] += voxel[c] / math.pi * light
    if not switches[HEMISPHERE]:
        return 0.0
    return sky_on_ground(scene, x, y, z + LIFT, voxel, DEPTH_LIMIT, step, quantum, chance, empty, total)


@njit(cache=True, nogil=True)
def _seen(scene, switches, o, d, event, step, empty):
    """Sun visibility of a recorded canopy step, under the switches for its own tree and the others."""
    x, y, z = o[0] + d[0] * event[S], o[1] + d[1] * event[S], o[2] + d[2] * event[S]
    others, within = switches[TREE_ON_TREE], switches[WITHIN_TREE]
    mode = ALL if others and within else (NOT_OWN if others else (ONLY_OWN if within else NONE))
    own = foot(scene, x, y, event[TU], event[TV], event[TK], True)
    return visibility(scene, switches, x, y, z, step, mode, own, empty)


@njit(cache=True, nogil=True)
def _scatter(
    scene, switches, o, d, record, light, n, tau, shadow_step, quantum, seed, pixel, first, empty, voxel, total
):
    """Add what n recorded steps scatter, from optical depth `tau` on, and their opacity.

    Returns the variance of the mean over channels, the number of random numbers used, and what the steps would send
    under a sky that nothing hides, mean over the channels, if that is still to be added.
    """
    sum_sun, sum_sky = 0.0, 0.0
    for e in range(n):
        depth = record[e, SIGMA] * record[e, DS]
        x, y = o[0] + d[0] * record[e, S], o[1] + d[1] * record[e, S]
        weight = math.exp(-tau) * -math.expm1(-depth) * kept(scene, x, y)
        tau += depth
        total[3] += weight
        _canopy_light(scene, switches, x, y, (-d[0], -d[1], -d[2]), record[e], voxel, light[e])
        light[e, 7] = (light[e, 0] + light[e, 1] + light[e, 2]) / 3.0
        light[e, 6] = weight * light[e, 7]
        sum_sky += light[e, 6]
        for c in range(3):
            total[c] += 0.0 if switches[HEMISPHERE] else weight * light[e, c] * voxel[7]
            light[e, 3 + c] *= weight
        light[e, 0] = (light[e, 3] + light[e, 4] + light[e, 5]) / 3.0
        sum_sun += light[e, 0]
    if sum_sun <= 0.0:
        return 0.0, 0, sum_sky
    if quantum <= 0.0:
        for e in range(n):
            if light[e, 0] > 0.0:
                seen = _seen(scene, switches, o, d, record[e], shadow_step, empty)
                for c in range(3):
                    total[c] += light[e, 3 + c] * seen
        return 0.0, 0, sum_sky
    # an even number of strata, so that each has a neighbour to tell the variance from
    strata = 2 * max(1, math.ceil(0.5 * sum_sun / quantum))
    part, at, passed, variance, before = sum_sun / strata, ZERO, light[0, 0], 0.0, 0.0
    for k in range(strata):
        target = (k + uniform(seed, pixel, first + k)) * part
        at, passed = pick(light, 0, n, target, at, passed)
        seen = _seen(scene, switches, o, d, record[at], shadow_step, empty)
        for c in range(3):
            total[c] += part * seen * light[at, 3 + c] / light[at, 0]
        if k % 2:
            variance += (part * (seen - before)) ** 2
        before = seen
    return variance, strata, sum_sky


@njit(cache=True, nogil=True)
def rows(scene, switches, origins, directions, behind, first, last, step_of, quanta, seed, sample, picture, variances):
    """Add one sub-pixel sample of rows [first, last) to `picture` (H, W, 4) and its variance to `variances` (H, W).

    Args:
        step_of: (vertical step, longest step) of the view march and (step) of the shadow march, m.
        quanta: unshadowed sunlight (mean radiance) per shadow ray, 0 gives every step its own; and light of an open sky
            per ray to it.
    """
    record, light = np.empty((512, COLUMNS)), np.empty((512, 8))
    empty, voxel, total = np.empty((0, COLUMNS)), np.empty(8), np.zeros(4)
    width = origins.shape[1]
    shadow_step = step_of[2]
    nowhere = (0.0, 0.0)
    for row in range(first, last):
        for column in range(width):
            o = (origins[row, column, 0], origins[row, column, 1], origins[row, column, 2])
            d = (directions[row, column, 0], directions[row, column, 1], directions[row, column, 2])
            step = min(step_of[0] / max(abs(d[2]), 1e-9), step_of[1])
            total[:] = 0.0
            s, tau, used, skywards, status, variance = 0.0, 0.0, ZERO, ZERO, FULL, 0.0
            pixel = (row * width + column) * 4096 + sample
            while status == FULL:
                before = tau
                status, s, tau, n = march(scene, o, d, s, tau, DEPTH_LIMIT, step, SOLID, ALL, nowhere, record)
                if n:
                    more, drawn, even = _scatter(scene, switches, o, d, record, light, n, before, shadow_step,
                                                 quanta[0], seed, pixel, used, empty, voxel, total)
                    variance += more
                    used += drawn
                    if switches[HEMISPHERE]:
                        more, drawn = sky_on_canopy(scene, o, d, record, light, n, even, DEPTH_LIMIT, shadow_step,
                                                    quanta[1], (seed, pixel, sample, skywards), empty, voxel, total)
                        variance += more
                        skywards += drawn
            through = math.exp(-tau)
            if status == OPAQUE:
                # what lies beyond the limit is taken to scatter like what lies before it
                total /= 1.0 - through
            elif status == GROUND:
                variance += _ground_light(scene, switches, o[0] + d[0] * s, o[1] + d[1] * s, o[2] + d[2] * s,
                                          shadow_step, quanta[1], (seed, pixel, sample, skywards), empty, through,
                                          voxel, total)
            for c in range(3):
                picture[row, column, c] += total[c] + (1.0 - total[3]) * behind[row, column, c]
            picture[row, column, 3] += total[3]
            variances[row, column] += variance
