"""A small knot behind its faces, drawn by a technique of selection, and what rays meet of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

from renderer.core.baking import bake_key, bake_now
from renderer.core.cache import Cache
from renderer.core.params import validate
from renderer.core.technique import BakedArrays
from renderer.directional.bakes import bakes
from renderer.directional.renderer import DirectionalRenderer
from renderer.directional.state import DirectionalState
from renderer.gl.context import GL
from renderer.gl.targets import Target
from renderer.gl.thread import GLThread
from renderer.world.camera import rays

SIZE = 64
NONE = 0xFFFFFFFF

SMALL: dict[str, Any] = {
    "scene": "directional",
    "subject": {"kind": "knot"},
    "cloud": {"points": 60_000},
    "visibility": {"texels": 64, "directions": 129},
    "hemispheres": {"directions": 33},
    "self_shadow": {"kind": "none"},
    "view": {"background": "none"},
}


@dataclass(frozen=True)
class Drawn:
    """A sample at the pixels' centres.

    Attributes:
        picture: (SIZE, SIZE, 4) premultiplied radiance, row 0 at the top.
        points: (height, width, count) numbers of the points chosen, rows from the bottom, `NONE` where there is none.
        positions: (M, 3) of all points [m]. mask: (SIZE, SIZE) where rays meet the knot.
        origins, directions: of the pixels' rays, (SIZE, SIZE, 3). box: (2, 3) [m].
    """

    picture: np.ndarray
    points: np.ndarray
    positions: np.ndarray
    mask: np.ndarray
    origins: np.ndarray
    directions: np.ndarray
    box: np.ndarray

    @property
    def wrong(self) -> float:
        """Share of the knot's pixels that are drawn empty, or of as many that are drawn beside it."""
        return float(((self.picture[..., 3] > 0.5) != self.mask).sum() / self.mask.sum())


def draw(thread: GLThread, patch: Mapping[str, Any]) -> Drawn:
    """Draw the small knot."""
    cache = Cache()
    state = validate(DirectionalState, {**SMALL, **patch})
    baked = {bake.name: BakedArrays(bake_key(bake), bake_now(bake, cache)) for bake in bakes(state)}
    picture, points = thread.call(_picture, state, baked)
    subject = baked["subject"].arrays
    scene = EmbreeScene()
    corners = np.ascontiguousarray(subject["vertices"][subject["faces"]], np.float32)
    mesh = TriangleMesh(scene, corners)
    origins, directions = rays(state.camera, SIZE, SIZE)
    starts, ways = (np.ascontiguousarray(part.reshape(-1, 3), np.float32) for part in (origins, directions))
    mask = (scene.run(starts, ways) >= 0).reshape(SIZE, SIZE)
    del mesh
    used = baked["visibility"].arrays["used"]
    positions = baked["cloud"].arrays["position"][used]
    box = np.asarray(baked["visibility"].arrays["box"])
    return Drawn(picture, points, positions, mask, origins, directions, box)


def _picture(gl: GL, state: DirectionalState, baked: Mapping[str, BakedArrays]) -> tuple[np.ndarray, np.ndarray]:
    renderer, target = DirectionalRenderer(gl), Target(gl, SIZE, SIZE)
    try:
        prepared = renderer.prepare(state, baked, (SIZE, SIZE), (0.5, 0.5), 0)
        target.use()
        renderer.draw(prepared)
        assert renderer.atlas is not None
        return target.read(), renderer.atlas.chosen_points()
    finally:
        renderer.release()
        target.release()


def orbit(azimuth: float, elevation: float) -> dict[str, Any]:
    """A camera round the knot."""
    return {
        "kind": "orbit",
        "target": [0, 0, 0.5],
        "distance": 3.4,
        "azimuth": azimuth,
        "elevation": elevation,
        "field_of_view": 30,
    }


def parallel(direction: np.ndarray) -> dict[str, Any]:
    """A parallel view of the knot, from a direction towards the eye."""
    way = [-float(value) for value in direction]
    return {"kind": "orthographic", "centre": [0, 0, 0.5], "direction": way, "up": [0, 0, 1], "width": 2.2}
