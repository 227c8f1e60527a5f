"""Voxel by voxel: constant voxels and ramps between them in closed form, and borders that are missed."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from tests.shells.conftest import even

Draw = Callable[..., np.ndarray]
FILE = "shells/sampling/dda.glsl"
SLANT = {"kind": "orthographic", "centre": [0, 0, 0.25], "direction": [0.28, 0, -0.96], "up": [0, 1, 0], "width": 0.1}


def layers(count: int) -> np.ndarray:
    """Layers of any opacity and colour, all even."""
    rng, block = np.random.default_rng(5), even(0.0, layers=count)
    block[:] = rng.uniform(0.0, 0.4, (count, 1, 1, 4))
    return block


def picture(draw: Draw, block: np.ndarray, interpolation: str) -> np.ndarray:
    voxels = {"interpolation": interpolation, "storage": "float"}
    found = draw({"sampling": {"kind": "dda"}, "voxels": voxels, "camera": SLANT}, block, reference_length=0.1)
    return np.asarray(found[4, 4])


def exact(block: np.ndarray, interpolation: str, parts: int = 4000) -> np.ndarray:
    """The same through layers by many small steps, in float64, from the top."""
    column, count = block[:, 0, 0].astype(np.float64), len(block)
    w = (np.arange(parts)[::-1] + 0.5) / parts * count - 0.5
    extinction = -np.log1p(-column[:, 3]) / 0.1
    premultiplied = np.concatenate([column[:, :3] * extinction[:, None], extinction[:, None]], 1)
    if interpolation == "nearest":
        read = premultiplied[np.clip(np.rint(w).astype(int), 0, count - 1)]
    else:
        read = np.stack([np.interp(w, np.arange(count), premultiplied[:, n]) for n in range(4)], 1)
    step = 0.5 / 0.96 / parts
    passed = np.exp(-np.cumsum(read[:, 3]) * step) / np.exp(-0.5 * read[:, 3] * step)
    return np.append((read[:, :3] * passed[:, None] * step).sum(0), 1 - np.exp(-read[:, 3].sum() * step))


@pytest.mark.parametrize(("interpolation", "near"), [("nearest", 2e-4), ("extinction", 2e-3)])
def test_layers_of_every_colour(draw: Draw, interpolation: str, near: float) -> None:
    block = layers(24)
    assert picture(draw, block, interpolation) == pytest.approx(exact(block, interpolation), abs=near)


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("(segment.far - segment.near) * width;", "(segment.far - segment.near) * 0.05;"),
        ("crossing += stride * vec3(", "crossing += 2.5 * stride * vec3("),
    ],
)
def test_wrong_lengths_are_found(draw: Draw, spoil: Callable, right: str, wrong: str) -> None:
    block = layers(24)
    with spoil(FILE, right, wrong):
        assert np.abs(picture(draw, block, "nearest") - exact(block, "nearest")).max() > 0.01
