"""A spruce: whorls of drooping branches on a straight stem, a cone of dark needles."""

from __future__ import annotations

import numpy as np

from renderer.world.tree import GOLDEN_ANGLE, Species, Tree, join, leaves, outwards, tubes

BARK = (0.075, 0.058, 0.045)
NEEDLES = (0.03, 0.07, 0.035)
WHORL_SPACING = 0.46
"""Between two years' branches near the top of a mature tree [m]."""


def grow(rng: np.random.Generator, height: float, crown_radius: float) -> Tree:
    """Grow a spruce of a given height and crown radius [m]."""
    levels = np.linspace(0, 1, 9)
    sway = np.cumsum(rng.normal(0, 0.012, (9, 2)), axis=0) * height / 9
    stem = np.concatenate([sway - sway[0], (levels * height)[:, None]], axis=1)
    trunk = tubes(stem[None], 0.011 * height * (1 - 0.97 * levels[None]), 7)

    bottom = 0.14 * height
    whorls = np.arange(bottom, height - 0.25, WHORL_SPACING)
    foot = np.repeat(whorls, 6) + rng.uniform(-0.16, 0.16, 6 * len(whorls))
    azimuth = (
        np.arange(len(foot)) * (2 * np.pi / 6)
        + np.repeat(np.arange(len(whorls)), 6) * GOLDEN_ANGLE
        + rng.normal(0, 0.16, len(foot))
    )
    rise = np.clip((foot - bottom) / (height - bottom), 0, 1)
    # A cone that bulges a little, with the lowest branches shaded out and short.
    profile = (1 - rise) ** 0.78 * np.clip(0.62 + 3.2 * rise, 0, 1)
    length = np.maximum(crown_radius * profile * rng.uniform(0.74, 1.04, len(foot)), 0.12)
    axis = _branch_axes(stem, height, foot, azimuth, length, rise)
    branches = tubes(axis, 0.012 + 0.012 * length[:, None] * (1 - np.linspace(0, 0.95, axis.shape[1])), 3)
    return join(
        [trunk, branches], [_sprays(rng, axis, length, height), _leader(rng, stem)], [BARK, BARK], NEEDLES, 0.16, rng
    )


def _branch_axes(
    stem: np.ndarray, height: float, foot: np.ndarray, azimuth: np.ndarray, length: np.ndarray, rise: np.ndarray
) -> np.ndarray:
    """Branch axes (B, 5, 3): rising near the top of the tree, drooping with a lifted tip further down."""
    s = np.linspace(0, 1, 5)
    out = np.stack([np.sin(azimuth), np.cos(azimuth)], axis=1)
    base = np.stack([np.interp(foot, stem[:, 2], stem[:, d]) for d in (0, 1)], axis=1)
    droop = np.interp(rise, [0, 0.5, 1], [-0.42, -0.22, 0.75])
    lift = np.interp(rise, [0, 1], [0.22, 0.0])
    climb = length[:, None] * (droop[:, None] * s + lift[:, None] * s**3)
    flat = base[:, None] + out[:, None] * (length[:, None] * s)[:, :, None]
    z = np.clip(foot[:, None] + climb, 0.3, height)
    return np.concatenate([flat, z[:, :, None]], axis=2)


def _sprays(
    rng: np.random.Generator, axis: np.ndarray, length: np.ndarray, height: float
) -> tuple[np.ndarray, np.ndarray]:
    """Needled twigs as narrow leaves to both sides of the branches, hanging, denser on long branches."""
    count = np.maximum((length * 9).astype(int), 4)
    branch = np.repeat(np.arange(len(length)), count)
    place = rng.uniform(0.12, 1.0, len(branch)) ** 0.8
    spot = place * (axis.shape[1] - 1)
    low = np.minimum(spot.astype(int), axis.shape[1] - 2)
    start, stop = axis[branch, low], axis[branch, low + 1]
    base = start + (stop - start) * (spot - low)[:, None]
    forward = (stop - start) / np.linalg.norm(stop - start, axis=1, keepdims=True)
    side = np.cross(forward, [0, 0, 1.0]) * rng.choice([-1.0, 1.0], len(branch))[:, None]
    reach = np.minimum(length[branch], 1.3) * rng.uniform(0.28, 0.5, len(branch)) * (1.15 - 0.5 * place) + 0.12
    along = (
        0.55 * forward
        + side * rng.uniform(0.2, 1.0, (len(branch), 1))
        + [0, 0, -0.32]
        + rng.normal(0, 0.16, (len(branch), 3))
    )
    along *= (reach / np.linalg.norm(along, axis=1))[:, None]
    centre = np.stack([np.zeros(len(base)), np.zeros(len(base)), base[:, 2] - 0.12 * height], axis=1)
    return leaves(base, along, outwards(base, centre, rng, up=0.9, disorder=0.3), 0.42 * reach)


def _leader(rng: np.random.Generator, stem: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The needled tip of the stem."""
    tip = stem[-1]
    base = tip + np.stack([np.zeros(14), np.zeros(14), -rng.uniform(0.05, 1.1, 14)], axis=1)
    azimuth = np.arange(14) * GOLDEN_ANGLE
    along = 0.28 * np.stack([np.sin(azimuth), np.cos(azimuth), np.full(14, 0.9)], axis=1)
    along[:, 2] = np.minimum(along[:, 2], tip[2] - base[:, 2])
    return leaves(base, along, outwards(base, tip - [0, 0, 1.5], rng, up=0.4, disorder=0.2), 0.12)


SPECIES = Species(
    "conifer",
    "Spruce",
    "Whorled monopodial form: Hallé, Oldeman & Tomlinson 1978, Massart's model",
    (16.0, 19.2),
    0.155,
    grow,
)
