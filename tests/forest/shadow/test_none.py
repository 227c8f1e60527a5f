"""No shadow: every point sees the whole sun, and the picture is the unshadowed one."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from renderer.forest.shadow.none import NoShadow
from tests.forest import worlds
from tests.forest.truth import MARCH, Judge

Ask = Callable[..., np.ndarray]
RNG = np.random.default_rng(4)


def test_everything_sees_the_sun(ask: Ask) -> None:
    inputs = {"position": RNG.normal(0, 900, (50, 3)), "h": RNG.uniform(0, 1, 50), "uv": RNG.uniform(0, 1, (50, 2))}
    for elevation in (-5, 5, 90):
        found = ask(["forest/shadow/none.glsl"], "shadow_visibility(position, h, uv)", inputs,
                    techniques={"shadow": NoShadow()}, state=worlds.state(sun=worlds.sun(0, elevation)))
        assert (found == 1).all()


def test_distance_to_the_reference(judge: Judge) -> None:
    judge.holds("shadow", "none", MARCH)  # against the truth without shadows
    judge.holds(
        "shadow", "none",
        MARCH,
        0.71,  # every shadow there is
        against="full",
    )


def test_a_missing_shadow_is_found(judge: Judge) -> None:
    assert judge.distance("shadow", "none", "full") > 10 * MARCH


def test_picture(judge: Judge) -> None:
    judge.looks("shadow", "none")
