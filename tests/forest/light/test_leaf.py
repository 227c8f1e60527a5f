"""Thin leaves: reflected on the side that the sun and the eye share, passed on across."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.forest.light.leaf import Leaf
from tests.forest import worlds
from tests.forest.facing import Leaves, drawn, light_error, sent, unit
from tests.forest.truth import MARCH, Judge

Ask = Callable[..., np.ndarray]


def everywhere(count: int) -> np.ndarray:
    """Directions spread evenly over the sphere: Fibonacci's spiral, (count, 3)."""
    n = np.arange(count) + 0.5
    z = 1 - 2 * n / count
    turn = n * np.pi * (1 + np.sqrt(5))
    return np.stack([np.sqrt(1 - z**2) * np.cos(turn), np.sqrt(1 - z**2) * np.sin(turn), z], axis=1)


def over_all_leaves(leaves: Leaves, sun: np.ndarray) -> np.ndarray:
    """The definition, leaf by leaf: what each sends counts by the area it shows; no closed form."""
    facing = everywhere(20000)

    def seen_and_lit(normals: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Area shown; and the same times the light on it, where both look at one side, and at two."""
        seen, lit = normals @ v, normals @ sun
        return np.abs(seen), np.maximum(seen * lit, 0), np.maximum(-seen * lit, 0)

    result = np.empty_like(leaves.albedo)
    for n in range(len(leaves.albedo)):
        kappa = leaves.flatness[n]
        flat = seen_and_lit(leaves.normal[n : n + 1], leaves.to_eye[n])
        wild = seen_and_lit(facing, leaves.to_eye[n])
        shown, same, across = (kappa * a.mean() + (1 - kappa) * b.mean() for a, b in zip(flat, wild, strict=True))
        result[n] = (leaves.albedo[n] * same + leaves.passed[n] * across) / (np.pi * shown)
    return result


def test_the_light_is_that_of_all_the_leaves(ask: Ask) -> None:
    # 20,000 leaves stand for all directions.
    assert light_error(ask, Leaf(), over_all_leaves) < 2e-4


@pytest.mark.parametrize(("right", "wrong"), [
    ("seen * lit > 0.0", "lit > 0.0"),
    ("matter.albedo : matter.passed", "matter.passed : matter.albedo"),
    ("same * matter.albedo + other * matter.passed", "same * matter.albedo"),
    ("(3.141592653589793 - angle)", "(1.570796326794897 - angle)"),
    ("mix(0.5, abs(seen), matter.flatness)", "1.0"),
])
def test_a_wrong_light_is_found(ask: Ask, spoil: Callable, right: str, wrong: str) -> None:
    with spoil("forest/light/leaf.glsl", right, wrong):
        assert light_error(ask, Leaf(), over_all_leaves) > 0.01


def test_no_more_leaves_than_came(ask: Ask) -> None:
    """Light that a leaf sends to all directions, weighted by the area it shows there, is what it took in."""
    for kappa in (0.0, 0.4, 0.95):
        v = everywhere(4000)
        full = np.full((len(v), 3), 1.0)
        normal = unit(np.array([0.3, -0.2, 0.5]))
        leaves = Leaves(0.6 * full, 0.4 * full, np.tile(normal, (len(v), 1)), np.full(len(v), kappa), full, v)
        for azimuth, elevation in ((20, 60), (250, 10)):
            found = sent(ask, Leaf(), leaves, worlds.sun(azimuth, elevation))[:, 0]
            shown = kappa * np.abs(v @ normal) + (1 - kappa) / 2
            s = np.array([np.sin(np.radians(azimuth)) * np.cos(np.radians(elevation)),
                          np.cos(np.radians(azimuth)) * np.cos(np.radians(elevation)), np.sin(np.radians(elevation))])
            taken = kappa * abs(normal @ s) + (1 - kappa) / 2
            assert 4 * np.pi * (found * shown).mean() == pytest.approx(taken, rel=2e-3)


def test_a_flat_opaque_leaf_is_lamberts(ask: Ask) -> None:
    leaves = drawn()._replace(flatness=np.ones(500), passed=np.zeros((500, 3)))
    lit = np.sign(np.sum(leaves.normal * leaves.to_eye, axis=1)) * leaves.normal[:, 2]
    found = sent(ask, Leaf(), leaves, worlds.sun(0, 90))
    assert found == pytest.approx(leaves.albedo / np.pi * np.maximum(lit, 0)[:, None], abs=1e-5)


def test_distance_to_the_reference(judge: Judge) -> None:
    judge.holds("light", "leaf", MARCH)  # the light is the reference's own


def test_picture(judge: Judge) -> None:
    judge.looks("light", "leaf")
