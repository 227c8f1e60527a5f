"""An oak-like broadleaf tree: a short stem and a rounded, lobed crown, grown by space colonisation."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from renderer.world.tree import Species, Tree, join, leaves, outwards, tubes, unit

BARK = (0.11, 0.085, 0.062)
GREEN = (0.06, 0.12, 0.03)
LEAVES = 6400

SEGMENT = 0.027
"""Length of one growth step, as a share of the height."""

TIP_RADIUS = 0.007
"""Radius of the last twig that is modelled [m]."""

STEM_RADIUS = 0.0125
"""Radius of the stem at the ground, as a share of the height."""

MURRAY = 2.4
"""Exponent of the pipe model: the power of the radius that is kept where branches part (Murray 1927 measured 2.5)."""


def grow(rng: np.random.Generator, height: float, crown_radius: float) -> Tree:
    """Grow a broadleaf tree of a given height and crown radius [m]."""
    points, parents = _colonise(rng, _buds(rng, height, crown_radius), height)
    radii = _pipes(parents)
    # So few twigs are modelled that their sum is too slender a stem: stretch the radii from the twigs' to a forest
    # oak's.
    radii = TIP_RADIUS + (radii - TIP_RADIUS) * (STEM_RADIUS * height - TIP_RADIUS) / (radii[0] - TIP_RADIUS)
    foliage = _foliage(rng, points, parents, radii, height)
    limbs = _limbs(points, parents, radii)
    return join(limbs, [foliage], [BARK] * len(limbs), GREEN, 0.18, rng)


def _buds(rng: np.random.Generator, height: float, crown_radius: float) -> np.ndarray:
    """Places that the branches seek (n, 3) [m]: an egg-shaped crown with lobes, denser outside, where the light
    is."""
    direction = unit(rng.normal(size=(1700, 3)))
    lobes = unit(rng.normal(size=(9, 3)) + [0, 0, 0.3])
    swell = 0.76 + 0.28 * np.exp(7 * (direction @ lobes.T - 1)).max(axis=1)
    depth = rng.uniform(0.25, 1.0, len(direction)) ** (1 / 2.2)
    low = np.where(direction[:, 2] < 0, 0.29, 0.40)
    place = direction * (depth * np.minimum(swell, 1.0))[:, None]
    return np.stack(
        [place[:, 0] * crown_radius, place[:, 1] * crown_radius, 0.565 * height + place[:, 2] * low * height], axis=1
    )


def _colonise(rng: np.random.Generator, buds: np.ndarray, height: float) -> tuple[np.ndarray, np.ndarray]:
    """Branch points (n, 3) and each one's parent, -1 for the root.

    Source: Runions, Lane & Prusinkiewicz 2007, section 3.
    """
    step = SEGMENT * height
    stem = np.arange(0, 0.34 * height, step)
    lean = np.cumsum(rng.normal(0, 0.05 * step, (len(stem), 2)), axis=0)
    points = np.concatenate([lean - lean[0], stem[:, None]], axis=1)
    parents = np.arange(-1, len(stem) - 1)
    for _ in range(70):
        distance, nearest = cKDTree(points).query(buds, distance_upper_bound=0.34 * height)
        buds = buds[(distance > 1.6 * step)]
        nearest, kept = nearest[distance > 1.6 * step], distance[distance > 1.6 * step]
        reached = np.isfinite(kept)
        if not reached.any():
            break
        pull = np.zeros_like(points)
        np.add.at(pull, nearest[reached], unit(buds[reached] - points[nearest[reached]]))
        growing = np.flatnonzero(np.abs(pull).sum(axis=1) > 1e-9)
        # A little disorder parts two shoots that would grow on top of one another for ever.
        heading = unit(unit(pull[growing]) + rng.normal(0, 0.12, (len(growing), 3)) + [0, 0, 0.06])
        points = np.concatenate([points, points[growing] + step * heading])
        parents = np.concatenate([parents, growing])
    return points, parents


def _pipes(parents: np.ndarray) -> np.ndarray:
    """Radius of the wood at every point [m]."""
    power = np.zeros(len(parents))
    for node in range(len(parents) - 1, -1, -1):
        power[node] = max(power[node], TIP_RADIUS**MURRAY)
        if parents[node] >= 0:
            power[parents[node]] += power[node]
    radii: np.ndarray = power ** (1 / MURRAY)
    return radii


def _limbs(points: np.ndarray, parents: np.ndarray, radii: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Tubes along every run from a fork to a tip, each following its thickest child."""
    heir = np.full(len(parents), -1)
    for node in np.argsort(radii[1:]) + 1:
        heir[parents[node]] = node
    by_length: dict[tuple[int, int], list[list[int]]] = {}
    for node in range(len(parents)):
        if parents[node] >= 0 and heir[parents[node]] == node:
            continue
        run = [node] if parents[node] < 0 else [int(parents[node]), node]
        while heir[run[-1]] >= 0:
            run.append(int(heir[run[-1]]))
        sides = 8 if parents[node] < 0 else 4 if radii[node] > 0.04 else 3
        by_length.setdefault((len(run), sides), []).append(run)
    parts = []
    for (length, sides), runs in by_length.items():
        if length > 1:
            chosen = np.array(runs)
            thickness = radii[chosen]
            # A side branch starts as thick as itself, not as the limb that it leaves.
            thickness[:, 0] = np.where(chosen[:, 0] == 0, thickness[:, 0] * 1.35, thickness[:, 1])
            parts.append(tubes(points[chosen], thickness, sides))
    return parts


def _foliage(
    rng: np.random.Generator, points: np.ndarray, parents: np.ndarray, radii: np.ndarray, height: float
) -> tuple[np.ndarray, np.ndarray]:
    """Clusters of leaves on the thin twigs."""
    twigs = np.flatnonzero((radii < 0.03) & (parents >= 0))
    each = int(np.clip(round(LEAVES / max(len(twigs), 1)), 3, 16))
    twig = np.repeat(twigs, each)
    along_twig = rng.uniform(0, 1.2, (len(twig), 1))
    start, stop = points[parents[twig]], points[twig]
    base = start + along_twig * (stop - start) + rng.normal(0, 0.010 * height, (len(twig), 3))
    base[:, 2] = np.minimum(base[:, 2], 0.985 * height)
    along = unit(unit(stop - start) * 0.6 + rng.normal(0, 0.8, (len(twig), 3)) + [0, 0, -0.25])
    along *= rng.uniform(0.017, 0.026, (len(twig), 1)) * height
    centre = np.array([0, 0, 0.5 * height])
    return leaves(base, along, outwards(base, centre, rng, up=0.7, disorder=0.35), 0.013 * height)


SPECIES = Species(
    "broadleaf", "Broadleaf", "Space colonisation: Runions, Lane & Prusinkiewicz 2007", (14.5, 18.0), 0.235, grow
)
