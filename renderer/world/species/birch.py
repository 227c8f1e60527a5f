"""A birch: a slender pale stem, rising branches with hanging twigs, small light leaves."""

from __future__ import annotations

import numpy as np

from renderer.world.tree import GOLDEN_ANGLE, Species, Tree, join, leaves, outwards, tubes, unit

BARK = (0.42, 0.40, 0.36)
TWIG_BARK = (0.10, 0.07, 0.05)
GREEN = (0.085, 0.15, 0.04)
BRANCHES = 60
TWIGS = 7
LEAVES = 12


def grow(rng: np.random.Generator, height: float, crown_radius: float) -> Tree:
    """Grow a birch of a given height and crown radius [m]."""
    levels = np.linspace(0, 1, 10)
    sway = np.cumsum(rng.normal(0, 0.02, (10, 2)), axis=0) * height / 10
    stem = np.concatenate([sway - sway[0], (levels * 0.985 * height)[:, None]], axis=1)
    trunk = tubes(stem[None], 0.0085 * height * (1 - 0.96 * levels[None] ** 0.9), 7)
    axis, length = _branches(rng, stem, height, crown_radius)
    branches = tubes(axis, (0.010 + 0.014 * length)[:, None] * np.linspace(1, 0.25, axis.shape[1]), 3)
    twigs = _twigs(rng, axis, length, height)
    wood = [trunk, branches, tubes(twigs, np.full(twigs.shape[:2], 0.007) * np.linspace(1, 0.5, twigs.shape[1]), 3)]
    return join(wood, [_leaves(rng, twigs, height)], [BARK, TWIG_BARK, TWIG_BARK], GREEN, 0.2, rng)


def _branches(
    rng: np.random.Generator, stem: np.ndarray, height: float, crown_radius: float
) -> tuple[np.ndarray, np.ndarray]:
    """Axes (B, 6, 3) and lengths [m]: rising steeply, spreading at the tips."""
    rise = np.linspace(0.0, 1.0, BRANCHES) ** 0.85
    foot = height * (0.27 + 0.68 * rise)
    azimuth = np.arange(BRANCHES) * GOLDEN_ANGLE + rng.normal(0, 0.25, BRANCHES)
    # An egg, widest below its middle, so that the crown is full but narrow.
    reach = crown_radius * np.sin(np.pi * np.clip(0.2 + 0.8 * rise, 0, 1)) ** 0.85 * rng.uniform(0.6, 0.98, BRANCHES)
    steep = np.interp(rise, [0, 1], [0.75, 1.9]) * rng.uniform(0.8, 1.2, BRANCHES)
    s = np.linspace(0, 1, 6)
    out = np.stack([np.sin(azimuth), np.cos(azimuth)], axis=1)
    base = np.stack([np.interp(foot, stem[:, 2], stem[:, d]) for d in (0, 1)], axis=1)
    # The top stays one shoot: no branch climbs more than most of the way from its foot to the tip.
    climb = np.minimum(reach * steep, 0.72 * (height - foot))[:, None] * (1.5 * s - 0.62 * s**2.5)
    z = foot[:, None] + climb
    flat = base[:, None] + out[:, None] * (reach[:, None] * s**1.15)[:, :, None]
    return np.concatenate([flat, z[:, :, None]], axis=2), np.hypot(reach, reach * steep)


def _twigs(rng: np.random.Generator, axis: np.ndarray, length: np.ndarray, height: float) -> np.ndarray:
    """Twig axes (T, 4, 3): leaving the branch sideways, then hanging."""
    branch = np.repeat(np.arange(len(axis)), TWIGS)
    spot = np.tile(np.linspace(0.28, 1.0, TWIGS), len(axis)) * (axis.shape[1] - 1)
    low = np.minimum(spot.astype(int), axis.shape[1] - 2)
    start, stop = axis[branch, low], axis[branch, low + 1]
    base = start + (stop - start) * (spot - low)[:, None]
    out = unit(unit(stop - start) + rng.normal(0, 0.75, base.shape))
    size = (0.28 * np.minimum(length[branch], 2.6) + 0.14) * rng.uniform(0.7, 1.3, len(branch))
    s = np.linspace(0, 1, 4)[None, :, None]
    twigs: np.ndarray = base[:, None] + size[:, None, None] * (
        out[:, None] * (s - 0.35 * s**2) + np.array([0, 0, -0.62]) * s**2
    )
    twigs[..., 2] = np.minimum(twigs[..., 2], 0.985 * height)
    return twigs


def _leaves(rng: np.random.Generator, twigs: np.ndarray, height: float) -> tuple[np.ndarray, np.ndarray]:
    twig = np.repeat(np.arange(len(twigs)), LEAVES)
    spot = rng.uniform(0.15, 1.0, len(twig)) * (twigs.shape[1] - 1)
    low = np.minimum(spot.astype(int), twigs.shape[1] - 2)
    start, stop = twigs[twig, low], twigs[twig, low + 1]
    base = start + (stop - start) * (spot - low)[:, None] + rng.normal(0, 0.07, (len(twig), 3))
    along = unit(rng.normal(0, 0.7, base.shape) + [0, 0, -0.55]) * rng.uniform(0.15, 0.25, (len(twig), 1))
    centre = np.stack([np.zeros(len(base)), np.zeros(len(base)), np.minimum(base[:, 2], 0.6 * height)], axis=1)
    return leaves(base, along, outwards(base, centre, rng, up=0.6, disorder=0.5), 0.13)


SPECIES = Species(
    "birch", "Birch", "Alternate branches at the golden angle; form after Betula pendula", (15.0, 18.0), 0.14, grow
)
