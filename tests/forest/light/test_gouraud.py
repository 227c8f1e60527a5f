"""Gouraud light: the cosine to the ground's normal, whatever the voxel."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.forest.light.gouraud import Gouraud
from tests.forest.facing import light_error
from tests.forest.truth import MARCH, Judge

Ask = Callable[..., np.ndarray]


def of_strength(strength: float) -> Callable[..., np.ndarray]:
    return lambda voxel, ground, sun: 1 + strength * (np.maximum(ground @ sun, 0) - 1)


@pytest.mark.parametrize("strength", [0.0, 0.3, 1.0])
def test_the_factor_is_the_slopes_cosine(ask: Ask, strength: float) -> None:
    assert light_error(ask, Gouraud(strength=strength), of_strength(strength)) < 1e-5


@pytest.mark.parametrize(("right", "wrong"), [
    ("dot(ground_normal, sun_direction)", "dot(voxel_normal, sun_direction)"),
    ("max(dot(ground_normal, sun_direction), 0.0)", "dot(ground_normal, sun_direction)"),
    ("mix(1.0, max(dot", "mix(0.0, max(dot"),
])
def test_a_wrong_factor_is_found(ask: Ask, spoil: Callable, right: str, wrong: str) -> None:
    with spoil("forest/light/gouraud.glsl", right, wrong), pytest.raises(AssertionError):
        # A negative factor is refused before its error is measured.
        assert light_error(ask, Gouraud(strength=0.7), of_strength(0.7)) < 0.1


def test_distance_to_the_reference(judge: Judge) -> None:
    judge.holds(
        "light", "gouraud",
        MARCH,
        0.40,  # crowns without a lit and a dark side
    )


def test_gouraud_is_told_from_the_voxels_own_light(judge: Judge) -> None:
    assert judge.distance("light", "gouraud") > 10 * MARCH


def test_picture(judge: Judge) -> None:
    judge.looks("light", "gouraud")
