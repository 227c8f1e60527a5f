"""What all orders share that draw cells: the opaque surface, seen from either side, and the background."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from tests.shells.order.test_walk import GLOBE
from tests.shells.order.worlds import difference, ordered

Draw = Callable[..., np.ndarray]
EXACT = ["depth_peeling", "fragment_lists", "k_buffer", "sxmpvo"]
BELOW = {
    "surface": {"kind": "plane", "size": 1.0},
    "camera": {"kind": "look", "eye": [0, 0.3, -1.5], "target": [0, 0, 0], "up": [0, 1, 0], "field_of_view": 60},
    "base": {"opaque": True, "colour": [0.2, 0.4, 0.8]},
}


@pytest.mark.parametrize("kind", EXACT)
def test_the_back_of_an_opaque_surface_hides_what_lies_on_it(draw: Draw, kind: str) -> None:
    """From below, the shell's rim is seen around the surface."""
    assert difference(draw, ordered(kind), BELOW, 32).max() < 2e-3


@pytest.mark.parametrize("kind", ["fragment_lists", "sxmpvo"])
def test_the_sky_shines_through(draw: Draw, kind: str) -> None:
    world = {**GLOBE, "view": {"background": "sky"}, "base": {"opaque": True}}
    sky = draw(world, np.zeros((4, 4, 4, 4), np.float32), size=32)[0, 0, :3]
    assert (sky > 0).all()
    assert difference(draw, ordered(kind), world, 32).max() < 2e-3 * max(1.0, float(sky.max()))


def test_a_surface_without_depth_is_found(draw: Draw, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("renderer.shells.order.sxmpvo.moderngl.DEPTH_TEST", 0)
    assert difference(draw, ordered("sxmpvo"), {**GLOBE, "base": {"opaque": True}}, 32).max() > 0.05
