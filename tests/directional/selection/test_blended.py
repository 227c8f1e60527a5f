"""Blended directions: the nearest alone where a view looks along it, and a mixture of four between."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from renderer.directional.casting import face_frame
from renderer.directional.hemisphere import hemisphere_of
from renderer.gl.thread import GLThread
from tests.directional.selection.test_nearest import ALONG
from tests.directional.selection.world import NONE, draw, orbit, parallel

BLENDED = {"kind": "blended", "magnification": "nearest"}
NEAREST = {"kind": "nearest", "magnification": "nearest"}


def difference(thread: GLThread) -> float:
    """Between both, along a direction of the face +y, relative to the mean."""
    views = [draw(thread, {"selection": kind, "camera": parallel(ALONG)}) for kind in (BLENDED, NEAREST)]
    one, other = (view.picture for view in views)
    return float(np.median(np.abs(one - other)[views[1].mask]) / other.mean())


def test_along_a_direction_it_is_the_nearest(thread: GLThread) -> None:
    assert difference(thread) < 0.02


def test_between_directions_opacity_is_shared(thread: GLThread) -> None:
    drawn = draw(thread, {"selection": BLENDED, "camera": orbit(30, 25)})
    alpha = drawn.picture[..., 3]
    assert ((alpha > 0.05) & (alpha < 0.95)).sum() > 0.1 * drawn.mask.sum()  # ghosts
    assert alpha.max() <= 1 + 1e-3
    assert int((drawn.points != NONE).sum()) <= 12 * 64**2


def test_it_is_continuous_where_the_nearest_leaps(thread: GLThread) -> None:
    """Across the border between two directions."""
    layout = hemisphere_of(129)
    elevation, border = layout.elevation()[6], (3.5 + np.array([-1e-3, 1e-3])) * 2 * np.pi / layout.azimuths
    sides = [
        np.array([np.cos(elevation) * np.cos(turn), np.cos(elevation) * np.sin(turn), np.sin(elevation)])
        @ face_frame(3)
        for turn in border
    ]
    changes = {}
    for name, kind in (("blended", BLENDED), ("nearest", NEAREST)):
        before, after = (draw(thread, {"selection": kind, "camera": parallel(side)}).picture for side in sides)
        changes[name] = float(np.abs(after - before).mean() / before.mean())
    assert changes["nearest"] > 0.05
    assert changes["blended"] < 0.1 * changes["nearest"]


def test_weights_the_wrong_way_round_are_found(thread: GLThread, spoil: Callable) -> None:
    with spoil(
        "directional/selection/blended.glsl", "directions, weights);", "directions, weights); weights = weights.wzyx;"
    ):
        assert difference(thread) > 0.05
