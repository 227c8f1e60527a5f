"""Gouraud light: the cosine to the ground's normal, whatever the voxel."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.forest.light.gouraud import Gouraud
from tests.forest.facing import Leaves, Twin, light_error
from tests.forest.truth import MARCH, Judge

Ask = Callable[..., np.ndarray]


def of_strength(strength: float) -> Twin:
    def twin(leaves: Leaves, sun: np.ndarray) -> np.ndarray:
        return leaves.albedo / np.pi * (1 + strength * (np.maximum(leaves.slope @ sun, 0) - 1))[:, None]

    return twin


@pytest.mark.parametrize("strength", [0.0, 0.3, 1.0])
def test_the_light_goes_with_the_slopes_cosine(ask: Ask, strength: float) -> None:
    assert light_error(ask, Gouraud(strength=strength), of_strength(strength)) < 1e-6


@pytest.mark.parametrize(("right", "wrong"), [
    ("dot(matter.slope, sun_direction)", "dot(matter.normal, sun_direction)"),
    ("max(dot(matter.slope, sun_direction), 0.0)", "dot(matter.slope, sun_direction)"),
    ("mix(1.0, max(dot", "mix(0.0, max(dot"),
])
def test_a_wrong_light_is_found(ask: Ask, spoil: Callable, right: str, wrong: str) -> None:
    with spoil("forest/light/gouraud.glsl", right, wrong), pytest.raises(AssertionError):
        # Negative light is refused before its error is measured.
        assert light_error(ask, Gouraud(strength=0.7), of_strength(0.7)) < 0.02


def test_distance_to_the_reference(judge: Judge) -> None:
    judge.holds(
        "light", "gouraud",
        MARCH,
        0.23,  # crowns without a lit and a dark side
    )


def test_gouraud_is_told_from_the_voxels_own_light(judge: Judge) -> None:
    assert judge.distance("light", "gouraud") > 10 * MARCH


def test_picture(judge: Judge) -> None:
    judge.looks("light", "gouraud")
