"""What a ray of the forest reference carries: light scattered at each step, with exact visibility of the sun.

Radiance leaving matter: E_sun V f + E_sky a g / pi, f and g what its leaves make of the sun and of an even sky
(`_leaves`). Steps along the view ray are all integrated; only the sun's visibility V, which costs a march of its own,
is sampled: by strata of equal unshadowed sunlight, one jittered shadow ray each. The estimate is unbiased for any
number of strata, and its mean over the channels is exact where nothing is shadowed.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

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
    TK,
    TU,
    TV,
    S,
    march,
)

NOMINAL_ALBEDO = 0.1
"""Albedo of a leaf (linear, mean over channels) that the number of strata refers to: brighter matter gets more rays."""

DEPTH_LIMIT = 9.2
"""Optical depth after which a march stops: a ten-thousandth of the light is left, and takes the colour of the rest."""

LIFT = 1e-3
"""Metres above the ground at which its shadow rays start, so that rounding does not make a facet shade itself."""

TERRAIN, FOREST_ON_GROUND, TREE_ON_TREE, WITHIN_TREE, LIGHT = range(5)
"""Switches of one rendering, in the order the compiled functions read them."""

LEAF, LAMBERT, GOURAUD = range(3)
"""Values of the switch LIGHT."""


@njit(cache=True, nogil=True)
def _uniform(seed: int, pixel: int, stratum: int) -> float:
    """A number in [0, 1) that depends on nothing but its arguments: splitmix64 (Steele, Lea and Flood 2014)."""
    z = np.uint64(seed) * np.uint64(0x9E3779B97F4A7C15) + np.uint64(pixel)
    for word in (np.uint64(0), np.uint64(stratum)):
        z = (z + word + np.uint64(0x9E3779B97F4A7C15)) & np.uint64(0xFFFFFFFFFFFFFFFF)
        z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        z = z ^ (z >> np.uint64(31))
    return float(z >> np.uint64(11)) * 2.0**-53


@njit(cache=True, nogil=True)
def visibility(scene, switches, x, y, z, step, mode, own, empty):
    """Share of the sun's beam that reaches a point: exp(-integral of extinction), 0 where the ground is in the way."""
    sun = (scene.sun[0], scene.sun[1], scene.sun[2])
    if sun[2] <= 0.0 and switches[TERRAIN]:
        # the ground continues without end: a ray that does not rise meets it
        return 0.0
    if mode == NONE and not switches[TERRAIN]:
        return 1.0
    status, _, tau, _ = march(scene, (x, y, z), sun, 0.0, 0.0, DEPTH_LIMIT, step, switches[TERRAIN], mode, own, empty)
    return 0.0 if status in (GROUND, OPAQUE) else math.exp(-tau)


@njit(cache=True, nogil=True)
def _leaves(normal, to_eye, sun):
    """What a voxel's leaves make of light, by its share of the reflected and of the transmitted.

    Thin sheets, each side of which reflects and passes on light as Lambert's paper does (Ross 1981; Shultis and Myneni
    1988). A share kappa of them lies across the mean normal, the others face everywhere alike, so that the mean of all
    normals is the given one; each counts by the area that it shows to the eye.

    Args:
        normal: mean of the leaves' unit normals, kappa long. to_eye, sun: unit vectors.

    Returns:
        Factors of reflectance and of transmittance for the sun, radiance per irradiance across its beam, 1/sr; and by
        how much the sides that are seen face the zenith, -1 to 1.
    """
    kappa = math.sqrt(normal[0] ** 2 + normal[1] ** 2 + normal[2] ** 2)
    scale = 1.0 / kappa if kappa > 0.0 else 0.0
    kappa = min(kappa, 1.0)
    lit = (normal[0] * sun[0] + normal[1] * sun[1] + normal[2] * sun[2]) * scale
    seen = (normal[0] * to_eye[0] + normal[1] * to_eye[1] + normal[2] * to_eye[2]) * scale
    cosine = min(max(sun[0] * to_eye[0] + sun[1] * to_eye[1] + sun[2] * to_eye[2], -1.0), 1.0)
    between = math.acos(cosine)
    # of leaves facing everywhere, the mean of |m.v||m.s| over those that eye and sun see from one side, and from two
    one_side = (math.sin(between) + (math.pi - between) * cosine) / (3.0 * math.pi)
    two_sides = (math.sin(between) - between * cosine) / (3.0 * math.pi)
    shown = max(kappa * abs(seen) + 0.5 * (1.0 - kappa), 1e-9)
    reflected, passed = (1.0 - kappa) * one_side, (1.0 - kappa) * two_sides
    if lit * seen > 0.0:
        reflected += kappa * lit * seen
    else:
        passed -= kappa * lit * seen
    # over all directions the mean of (m.v) m is v / 3
    upwards = (kappa * seen * normal[2] * scale + (1.0 - kappa) * to_eye[2] / 3.0) / shown
    return reflected / (math.pi * shown), passed / (math.pi * shown), upwards


@njit(cache=True, nogil=True)
def _is_wood(scene, tu, tv, tk):
    """Whether the nearest voxel is trunk or branch, through which no light passes."""
    size, layers = scene.anchor.shape[2], scene.anchor.shape[0]
    k = min(max(math.floor(tk + 0.5), 0), layers - 1)
    return scene.anchor[k, math.floor(tv + 0.5) % size, math.floor(tu + 0.5) % size, 3] > 127


@njit(cache=True, nogil=True)
def _canopy_light(scene, switches, x, y, to_eye, event, voxel, out):
    """Unshadowed radiance that matter at a recorded step scatters: out[0:3] from the sky, out[3:6] from the sun."""
    tu, tv, tk = event[TU], event[TV], event[TK]
    voxel_at(scene, tu, tv, tk, voxel)
    sun = (scene.sun[0], scene.sun[1], scene.sun[2])
    normal = (2.0 * voxel[4] - 1.0, 2.0 * voxel[5] - 1.0, 2.0 * voxel[6] - 1.0)
    reflected, passed, upwards = _leaves(normal, to_eye, sun)
    if switches[LIGHT] != LEAF:
        nx, ny, nz = ground_normal(scene, x, y) if switches[LIGHT] == GOURAUD else normal
        length = math.sqrt(nx * nx + ny * ny + nz * nz)
        facing = (nx * sun[0] + ny * sun[1] + nz * sun[2]) / length if length > 0.0 else 0.0
        reflected, passed = max(facing, 0.0) / math.pi, 0.0
    foot_x, foot_y = foot(scene, x, y, tu, tv, tk, False)
    shade = (1.0 + scene.tint * tint(foot_x, foot_y)) / voxel[3]
    opaque = _is_wood(scene, tu, tv, tk)
    for c in range(3):
        albedo = voxel[c] * shade
        through = 0.0 if opaque else min(scene.leaf_transmission[c] * albedo, max(1.0 - albedo, 0.0))
        evenly = 0.5 * (albedo + through + upwards * (albedo - through))
        out[c] = evenly * scene.e_sky[c] * voxel[7] / math.pi
        out[3 + c] = (albedo * reflected + through * passed) * scene.e_sun[c]


@njit(cache=True, nogil=True)
def _ground_light(scene, switches, x, y, z, step, empty, share, voxel, total):
    """Add the light that bare ground sends up, times `share`, and its opacity."""
    share *= kept(scene, x, y)
    total[3] += share
    soil = 1.0 + scene.patches * patches(x, y)
    nx, ny, nz = ground_normal(scene, x, y)
    ambient = 1.0
    if bilinear(scene.cover, scene.cell, x, y) > 0.5:
        tu, tv = texel(scene, x, y)
        voxel_at(scene, tu, tv, 0.0, voxel)
        ambient = voxel[7]
    ambient *= 0.5 * (1.0 + nz)
    facing = max(nx * scene.sun[0] + ny * scene.sun[1] + nz * scene.sun[2], 0.0)
    seen = 0.0
    if facing > 0.0:
        mode = ALL if switches[FOREST_ON_GROUND] else NONE
        seen = visibility(scene, switches, x, y, z + LIFT, step, mode, (0.0, 0.0), empty)
    for c in range(3):
        light = scene.e_sun[c] * facing * seen + scene.e_sky[c] * ambient
        total[c] += share * scene.ground[c] * soil / math.pi * light


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

    Returns the variance of the mean over channels, and the number of random numbers used.
    """
    sum_sun = 0.0
    for e in range(n):
        depth = record[e, SIGMA] * record[e, DS]
        x, y = o[0] + d[0] * record[e, S], o[1] + d[1] * record[e, S]
        weight = math.exp(-tau) * -math.expm1(-depth) * kept(scene, x, y)
        tau += depth
        total[3] += weight
        _canopy_light(scene, switches, x, y, (-d[0], -d[1], -d[2]), record[e], voxel, light[e])
        for c in range(3):
            total[c] += weight * light[e, c]
            light[e, 3 + c] *= weight
        light[e, 0] = (light[e, 3] + light[e, 4] + light[e, 5]) / 3.0
        sum_sun += light[e, 0]
    if sum_sun <= 0.0:
        return 0.0, 0
    if quantum <= 0.0:
        for e in range(n):
            if light[e, 0] > 0.0:
                seen = _seen(scene, switches, o, d, record[e], shadow_step, empty)
                for c in range(3):
                    total[c] += light[e, 3 + c] * seen
        return 0.0, 0
    # an even number of strata, so that each has a neighbour to tell the variance from
    strata = 2 * max(1, math.ceil(0.5 * sum_sun / quantum))
    part, e, passed, variance, before = sum_sun / strata, 0, light[0, 0], 0.0, 0.0
    for k in range(strata):
        target = (k + _uniform(seed, pixel, first + k)) * part
        while passed <= target and e < n - 1:
            e += 1
            passed += light[e, 0]
        while light[e, 0] <= 0.0 and e > 0:
            # rounding can leave the last target beyond the sum, on a step that gives no sunlight
            e -= 1
        seen = _seen(scene, switches, o, d, record[e], shadow_step, empty)
        for c in range(3):
            total[c] += part * seen * light[e, 3 + c] / light[e, 0]
        if k % 2:
            variance += (part * (seen - before)) ** 2
        before = seen
    return variance, strata


@njit(cache=True, nogil=True)
def rows(scene, switches, origins, directions, behind, first, last, step_of, quantum, seed, sample, picture, variances):
    """Add one sub-pixel sample of rows [first, last) to `picture` (H, W, 4) and its variance to `variances` (H, W).

    Args:
        step_of: (vertical step, longest step) of the view march and (step) of the shadow march, m.
        quantum: unshadowed sunlight (mean radiance) per shadow ray; 0 gives every step its own.
    """
    record, light = np.empty((512, COLUMNS)), np.empty((512, 6))
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
            s, tau, used, status, variance = 0.0, 0.0, 0, FULL, 0.0
            pixel = (row * width + column) * 4096 + sample
            while status == FULL:
                before = tau
                status, s, tau, n = march(scene, o, d, s, tau, DEPTH_LIMIT, step, True, ALL, nowhere, record)
                if n:
                    more, drawn = _scatter(scene, switches, o, d, record, light, n, before, shadow_step, quantum, seed,
                                           pixel, used, empty, voxel, total)
                    variance += more
                    used += drawn
            through = math.exp(-tau)
            if status == OPAQUE:
                # what lies beyond the limit is taken to scatter like what lies before it
                total /= 1.0 - through
            elif status == GROUND:
                _ground_light(scene, switches, o[0] + d[0] * s, o[1] + d[1] * s, o[2] + d[2] * s, shadow_step, empty,
                              through, voxel, total)
            for c in range(3):
                picture[row, column, c] += total[c] + (1.0 - total[3]) * behind[row, column, c]
            picture[row, column, 3] += total[3]
            variances[row, column] += variance
