"""Patches of the ground: the reference's own noise, smooth, within bounds, and without a period."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.reference.forest_lookup import patches
from tests.forest.conftest import Ask, Spoil

FILE = "lib/patches.glsl"
RNG = np.random.default_rng(12)
Noise = Callable[[np.ndarray, np.ndarray], np.ndarray]

reference: Noise = np.vectorize(patches)


def difference(ask: Ask) -> float:
    """Worst difference between shader and reference, on the map and far beyond it."""
    xy = np.concatenate([RNG.uniform(-3000, 3000, (2000, 2)), RNG.uniform(-30, 30, (500, 2))]).astype(np.float32)
    found = ask([FILE], "patches_at(xy)", {"xy": xy})[:, 0]
    return float(np.abs(found - reference(xy[:, 0].astype(float), xy[:, 1].astype(float))).max())


def test_shader_and_reference_see_the_same_patches(ask: Ask) -> None:
    assert difference(ask) < 5e-4, "a place 3 km off is known to 0.1 mm, the slope is below 0.5 a metre"


@pytest.mark.parametrize(("right", "wrong"), [
    ("0.8 * xy.x - 0.6", "0.8 * xy.x + 0.6"),
    ("* (3.0 - 2.0 * f)", ""),
    ("turned / PATCH_FINE, 6u", "turned / PATCH_FINE, 5u"),
    ("mix(south_row, north_row, w.y)", "mix(north_row, south_row, w.y)"),
])
def test_other_patches_are_found(ask: Ask, spoil: Spoil, right: str, wrong: str) -> None:
    with spoil(FILE, right, wrong):
        assert difference(ask) > 0.1


def correlation(noise: Noise, shift: tuple[float, float]) -> float:
    """Of the noise with itself, moved by `shift` metres."""
    x, y = np.random.default_rng(3).uniform(-2000, 2000, (2, 20000))
    return float(np.corrcoef(noise(x, y), noise(x + shift[0], y + shift[1]))[0, 1])


def worst(noise: Noise) -> float:
    """Greatest correlation over shifts of more than two coarse cells, in a hundred directions and lengths."""
    turns, lengths = np.linspace(0, np.pi, 10), np.geomspace(52, 400, 10)
    return max(abs(correlation(noise, (a * np.sin(t), a * np.cos(t)))) for t in turns for a in lengths)


def sines(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """What the patches were, and what showed as ripples."""
    x, y = 0.37 * x, 0.37 * y
    return np.sin(x * 0.37 + 1.3 * np.sin(y * 0.11)) * np.sin(y * 0.41 + 1.7 * np.sin(x * 0.13))


def test_nothing_comes_round_again() -> None:
    assert worst(reference) < 0.05
    assert worst(sines) > 0.2


def test_values_keep_to_their_bounds_and_have_no_bias() -> None:
    x, y = np.random.default_rng(4).uniform(-3000, 3000, (2, 50000))
    values = reference(x, y)
    assert np.abs(values).max() <= 1
    assert abs(values.mean()) < 0.02
    assert 0.2 < values.std() < 0.4
    # smoothstep between nodes: at most 1.5 x 2 over the cell, either octave, along both axes
    steepest = np.sqrt(2) * 3 * (0.65 / 25 + 0.35 / 10)
    assert np.abs(reference(x + 1e-3, y) - values).max() < steepest * 1e-3
