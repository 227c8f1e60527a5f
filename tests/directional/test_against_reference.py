"""What is drawn beside the float64 reference of the same state, ray by ray at the pixels' centres.

The views look straight on one face of the box, along a direction that it has: what is left between the two are the
points themselves (their spacing, 16 bits of a normal and of a coordinate, 8 of a colour and of the openness) and what
the hemispheres round off.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np
import pytest

from renderer.core.baking import bake_key, bake_now
from renderer.core.cache import Cache
from renderer.core.params import validate
from renderer.core.technique import Bake, BakedArrays
from renderer.directional.bakes import bakes
from renderer.directional.renderer import DirectionalRenderer
from renderer.directional.state import DirectionalState
from renderer.directional.world_arrays import world_arrays
from renderer.gl.context import GL
from renderer.gl.targets import Target
from renderer.gl.thread import GLThread
from renderer.study.silhouettes import away
from renderer.truth_scenes import RENDER
from renderer.world.camera import rays

SIZE = 64
CENTRE = np.array([[0.5, 0.5]])

TUBE: dict[str, Any] = {
    "scene": "directional",
    "subject": {"kind": "knot", "strands": 1, "twist": 0},
    "cloud": {"points": 100_000},
    "visibility": {"texels": 64, "directions": 33},
    "hemispheres": {"directions": 129},
    "selection": {"kind": "nearest", "magnification": "nearest"},
    "self_shadow": {"kind": "none"},
    "view": {"background": "none"},
    "camera": {"kind": "orthographic", "centre": [0, 0, 0.3], "direction": [0, 0, -1], "up": [0, 1, 0], "width": 2.1},
    "sun": {"kind": "direction", "azimuth": 100, "elevation": 50},
}
"""A smooth tube in a knot, from straight above."""


Beside = Callable[..., tuple[np.ndarray, np.ndarray]]


@pytest.fixture(scope="module")
def beside(thread: GLThread) -> Iterator[Beside]:
    """The picture of a state, and its reference: `beside(patch, shadows)`."""
    renderer, cache, kept = thread.call(DirectionalRenderer), Cache(), dict[str, BakedArrays]()

    def known(bake: Bake) -> BakedArrays:
        key = bake_key(bake)
        if key not in kept:
            kept[key] = BakedArrays(key, bake_now(bake, cache))
        return kept[key]

    def both(patch: Mapping[str, Any], shadows: bool = False) -> tuple[np.ndarray, np.ndarray]:
        state = validate(DirectionalState, {**TUBE, **patch})
        baked = {bake.name: known(bake) for bake in bakes(state)}
        return thread.call(_picture, renderer, state, baked), _reference(state, baked, shadows)

    yield both
    thread.call(lambda gl: renderer.release())


def _reference(state: DirectionalState, baked: Mapping[str, BakedArrays], shadows: bool) -> np.ndarray:
    world = world_arrays(state, {name: entry.arrays for name, entry in baked.items()})
    world.pop("background")
    box, texels = baked["visibility"].arrays["box"], state.visibility.texels

    def looking(place: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
        """Rays through the middles of the texels that the pixels' centres lie in."""
        origins, directions = rays(state.camera, SIZE, SIZE, place)
        low, extent = box[0, :2], (box[1] - box[0])[:2]
        origins[..., :2] = low + (np.floor((origins[..., :2] - low) / extent * texels) + 0.5) / texels * extent
        return origins, directions

    right = RENDER["directional"](world, looking, CENTRE, {"shadows": shadows}, lambda share, words: None)
    return np.asarray(right["linear"])


def _picture(
    gl: GL, renderer: DirectionalRenderer, state: DirectionalState, baked: Mapping[str, BakedArrays]
) -> np.ndarray:
    target = Target(gl, SIZE, SIZE)
    try:
        prepared = renderer.prepare(state, baked, (SIZE, SIZE), (0.5, 0.5), 0)
        target.use()
        renderer.draw(prepared)
        return target.read()
    finally:
        target.release()


def apart(found: np.ndarray, right: np.ndarray) -> tuple[float, float]:
    """Relative RMSE over what is away from the silhouette, and the median error over the mean there."""
    mask = away(right[..., 3], 1.5)
    off, level = (found - right)[mask][:, :3], right[mask][:, :3].mean()
    return float(np.sqrt(np.mean(off**2))) / level, float(np.median(np.abs(off))) / level


MATT = {"kind": "phong", "ambient": 0, "diffuse": 0.9, "specular": 0}
NIGHT = {"kind": "direction", "azimuth": 0, "elevation": -10}
SUNLIT: dict[str, Any] = {"light": MATT}
LAMPLIT: dict[str, Any] = {"light": MATT, "lamp": {"lit": True}, "sun": NIGHT}
SKYLIT: dict[str, Any] = {"light": {**MATT, "ambient": 1, "diffuse": 0}}
TABLE: dict[str, Any] = {
    "light": {"kind": "measured_brdf", "ambient": 0},
    "material": {"kind": "validation"},
    "cloud": {"points": 200_000},  # its colours turn fast with the normal: 0.20, 0.15, 0.09 with 50, 100, 400 thousand
}
AROUND: dict[str, Any] = {"light": {"kind": "environment", "specular": 0}, "environment": {"kind": "studio"}}
BITS: dict[str, Any] = {"light": MATT, "self_shadow": {"kind": "bits"}}


@pytest.mark.parametrize(
    ("patch", "shadows", "budget"),
    [
        (SUNLIT, False, 0.08),  # points 9 mm apart on a tube as thick as a finger: the next one's normal
        (LAMPLIT, False, 0.14),  # the same, and that the lamp is near
        (SKYLIT, True, 0.065),  # openness by 129 directions, in 8 bits
        (TABLE, False, 0.13),  # half of it the points' spacing
        (AROUND, True, 0.085),  # openness, and irradiance by a few harmonics
        (BITS, True, 0.24),  # cells of 20 degrees in which the sun is all or nothing
    ],
    ids=["sun", "lamp", "sky", "table", "surroundings", "shadow"],
)
def test_each_light_is_the_references(beside: Beside, patch: dict[str, Any], shadows: bool, budget: float) -> None:
    found, right = beside(patch, shadows)
    error, median = apart(found, right)
    assert error < budget
    assert median < 0.05
    mask = right[..., 3] > 0.5
    assert ((found[..., 3] > 0.5) == mask).all(), "the silhouette of a face that looks along the view is exact"
    assert found[mask][:, :3].mean() == pytest.approx(right[mask][:, :3].mean(), rel=0.015)


@pytest.mark.parametrize(
    ("patch", "wrong", "shadows", "least"),
    [
        (SUNLIT, {"sun": {"kind": "direction", "azimuth": 100, "elevation": 40}}, False, 0.12),
        (LAMPLIT, {"lamp": {"lit": True, "place": (0.9, 1.0, 1.2)}}, False, 0.3),
        (SKYLIT, {}, False, 0.12),
        (TABLE, {"sun": {"kind": "direction", "azimuth": 280, "elevation": 50}}, False, 0.3),
        (AROUND, {"environment": {"kind": "studio", "rotation": 90}}, True, 0.12),
        (BITS, {"self_shadow": {"kind": "none"}}, True, 0.3),
    ],
    ids=["sun", "lamp", "sky", "table", "surroundings", "shadow"],
)
def test_another_light_is_told_apart(
    beside: Beside, patch: dict[str, Any], wrong: dict[str, Any], shadows: bool, least: float
) -> None:
    found = beside({**patch, **wrong}, shadows)[0]
    assert apart(found, beside(patch, shadows)[1])[0] > least


def test_a_mirror_shows_what_the_references_shows(beside: Beside) -> None:
    """A mirror doubles what a normal is off by, and a low sun has edges: the median tells."""
    mirror = {"light": {"kind": "environment", "diffuse": 0, "specular": 1}, "environment": {"kind": "evening"}}
    found, right = beside(mirror)
    assert apart(found, right)[1] < 0.02
    turned = beside({**mirror, "environment": {"kind": "evening", "rotation": 90}})[0]
    assert apart(turned, right)[1] > 0.04


def test_highlights_stand_where_the_references_stand(beside: Beside) -> None:
    """Four times as steep as a cosine: errors of a normal count as often."""
    broad: dict[str, Any] = {"kind": "phong", "ambient": 0, "diffuse": 0, "specular": 0.5, "shininess": 4}
    found, right = beside({"light": broad})
    assert apart(found, right)[0] < 0.42
    narrow = beside({"light": {**broad, "shininess": 8}})[0]
    assert apart(narrow, right)[0] > 0.7
