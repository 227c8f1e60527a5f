"""Position-corrected: the chosen points lie on the pixels' rays, and the edge is where the mesh has it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.gl.thread import GLThread
from tests.directional.selection.world import NONE, Drawn, draw, orbit

CORRECTED = {"kind": "position_corrected"}
VIEWS = ((30, 25), (200, 8), (290, 60))


def off_the_ray(drawn: Drawn) -> np.ndarray:
    """Of every chosen point, in texels of the longest side."""
    numbers = drawn.points[::-1, :, 0]
    found = numbers != NONE
    away = drawn.positions[numbers[found]] - drawn.origins[found]
    along = drawn.directions[found]
    across = away - (away * along).sum(axis=1, keepdims=True) * along
    return np.asarray(np.linalg.norm(across, axis=1) / ((drawn.box[1] - drawn.box[0]).max() / 64))


@pytest.mark.parametrize("view", VIEWS)
def test_what_is_chosen_lies_on_the_ray(thread: GLThread, view: tuple[float, float]) -> None:
    drawn = draw(thread, {"selection": CORRECTED, "camera": orbit(*view)})
    away = off_the_ray(drawn)
    # Half a texel's diagonal, and as far as 60,000 points are from each other; of four texels the nearest is taken.
    assert away.max() < 0.71 + 0.4
    assert np.percentile(away, 90) < 0.55


@pytest.mark.parametrize("view", VIEWS)
def test_edges_are_nearer_the_truth_than_the_nearest_has_them(thread: GLThread, view: tuple[float, float]) -> None:
    corrected = draw(thread, {"selection": CORRECTED, "camera": orbit(*view)}).wrong
    nearest = draw(thread, {"selection": {"kind": "nearest"}, "camera": orbit(*view)}).wrong
    assert corrected < 0.05
    assert corrected < 0.35 * nearest


def test_a_ray_without_parallax_is_found(thread: GLThread, spoil: Callable) -> None:
    with spoil(
        "directional/selection/position_corrected.glsl",
        "looks.drift_u = looks.scale.x * (looks.to_eye.z * u - looks.to_eye.x);",
        "looks.drift_u = vec4(0.0);",
    ):
        drawn = draw(thread, {"selection": CORRECTED, "camera": orbit(30, 25)})
    assert drawn.wrong > 0.05


def test_a_ray_that_is_given_up_is_found(thread: GLThread, spoil: Callable) -> None:
    with spoil("directional/selection/position_corrected.glsl", "CROSSED = 2 * TEXELS", "CROSSED = TEXELS / 8"):
        drawn = draw(thread, {"selection": CORRECTED, "camera": orbit(200, 8)})
    assert drawn.wrong > 0.05
