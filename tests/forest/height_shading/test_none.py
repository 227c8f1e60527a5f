"""No height shading: the identity, and what is left of the reference without it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from renderer.forest.height_shading.none import NoHeightShading
from tests.forest.truth import MARCH, Judge


def test_every_height_is_left_alone(ask: Callable[..., np.ndarray]) -> None:
    found = ask(["forest/height_shading/none.glsl"], "height_factor(h)", {"h": np.linspace(0, 1, 20)},
                techniques={"height_shading": NoHeightShading()})
    assert (found == 1).all()


def test_distance_to_the_reference(judge: Judge) -> None:
    judge.holds("height_shading", "none", MARCH)


def test_shading_where_the_truth_has_none_is_found(judge: Judge) -> None:
    assert judge.distance("height_shading", "empirical") > 10 * MARCH


def test_picture(judge: Judge) -> None:
    judge.looks("height_shading", "none")
