"""No shadow: every point sees the whole sun, and the picture is the unshadowed one."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from renderer.forest.shadow.none import NoShadow
from tests.forest import worlds
from tests.forest.truth import Judge

Ask = Callable[..., np.ndarray]
RNG = np.random.default_rng(4)


def test_everything_sees_the_sun(ask: Ask) -> None:
    inputs = {"position": RNG.normal(0, 900, (50, 3)), "h": RNG.uniform(0, 1, 50), "uv": RNG.uniform(0, 1, (50, 2))}
    for elevation in (-5, 5, 90):
        found = ask(["forest/shadow/none.glsl"], "shadow_visibility(position, h, uv)", inputs,
                    techniques={"shadow": NoShadow()}, state=worlds.state(sun=worlds.sun(0, elevation)))
        assert (found == 1).all()


def test_distance_to_the_reference(judge: Judge) -> None:
    """Against the unshadowed truth it costs the march alone; against the full truth, every shadow there is."""
    judge.holds("shadow", "none", budget=0.0)
    judge.holds("shadow", "none", budget=0.0, against="full")


def test_a_missing_shadow_is_found(judge: Judge) -> None:
    assert judge.distance("shadow", "none", "full") > 3 * judge.distance("shadow", "none")


def test_picture(judge: Judge) -> None:
    judge.looks("shadow", "none")
