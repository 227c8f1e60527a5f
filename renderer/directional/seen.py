"""What the faces see, as far as the GPU holds it: only the directions that the camera needs."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from renderer.core.errors import LimitError
from renderer.core.technique import Arrays
from renderer.directional.casting import AXES, NONE
from renderer.directional.hemisphere import hemisphere_of
from renderer.directional.tiles import occupied
from renderer.directional.visibility import layer
from renderer.gl.context import GL

BYTES_KEPT = 512 << 20
"""Of layers on the GPU, unless a view needs more."""

DEEPEST = 65534
"""Depth of a point on the far side of the box, as the GPU holds it; one more where there is no point."""

BYTES_MOST = 2 << 30
"""Of layers that one view may need."""


class Seen:
    """Layers of point numbers on the GPU, and where each direction of each face lies.

    Args:
        gl: the context's objects.
        visibility, cloud: arrays of the bakes.
        texels: of a face's side. directions: of a face's hemisphere.
    """

    def __init__(self, gl: GL, visibility: Arrays, cloud: Arrays, texels: int, directions: int) -> None:
        self._gl = gl
        self._visibility = visibility
        self._texels = texels
        self._directions = directions
        self._where = np.full((6, directions), -1, np.int32)
        self._holds: list[tuple[int, int] | None] = []
        self._asked = np.zeros(0, np.int64)
        self._turn = 0
        self._layers: Any = None
        self._depths: Any = None
        box = np.asarray(visibility["box"])
        positions = cloud["position"][visibility["used"]]
        self.cells = occupied(positions, box)
        share = (positions - box[0]) / (box[1] - box[0])
        self._height = np.ascontiguousarray(np.rint(np.clip(share.T, 0, 1) * DEEPEST).astype(np.uint16))
        layout = hemisphere_of(directions)
        self._cells = layout.cells()
        self._table = gl.texture2d(self._where, "nearest")
        self._round = gl.texture2d(self._where[:, self._cells], "nearest")

    @property
    def textures(self) -> dict[str, Any]:
        """Samplers of `shaders/directional/faces.glsl`."""
        return {"seen": self._layers, "seen_depth": self._depths, "seen_layer": self._table,
                "seen_round": self._round}  # fmt: skip

    def hold(self, wanted: Iterable[tuple[int, int]]) -> None:
        """Have the layers of these faces and directions.

        Raises:
            LimitError: more than the machine can hold at once.
        """
        self._turn += 1
        pairs = list(wanted)
        missing = []
        for pair in pairs:
            place = int(self._where[pair])
            if place < 0:
                missing.append(pair)
            else:
                self._asked[place] = self._turn
        if not missing and self._layers is not None:
            return
        if len(pairs) > len(self._holds):
            self._make(len(pairs))
            missing = pairs
        free = np.argsort(self._asked, kind="stable")[: len(missing)].tolist()
        side = self._texels
        for place, pair in zip(free, missing, strict=True):
            if (before := self._holds[place]) is not None:
                self._where[before] = -1
            numbers = np.ascontiguousarray(layer(self._visibility, *pair), np.uint32)
            self._layers.write(numbers.tobytes(), viewport=(0, 0, place, side, side, 1), alignment=1)
            depths = self._depth_of(numbers, pair[0])
            self._depths.write(depths.tobytes(), viewport=(0, 0, place, side, side, 1), alignment=1)
            self._holds[place], self._asked[place], self._where[pair] = pair, self._turn, place
        self._table.write(self._where.tobytes(), alignment=1)
        self._round.write(self._where[:, self._cells].tobytes(), alignment=1)

    def release(self) -> None:
        """Free everything."""
        self._table.release()
        self._round.release()
        if self._layers is not None:
            self._layers.release()
            self._depths.release()
            self._layers = self._depths = None

    def _depth_of(self, numbers: np.ndarray, face: int) -> np.ndarray:
        """Of a layer's points below their face, uint16."""
        seen = numbers != NONE
        depth = np.full(numbers.shape, DEEPEST + 1, np.uint16)
        height = self._height[AXES[face][2]][numbers[seen]]
        depth[seen] = DEEPEST - height if face % 2 else height
        return depth

    def _make(self, needed: int) -> None:
        """Room for as many layers, and for more where they are small."""
        size = self._texels**2 * 6
        most = min(int(self._gl.ctx.info["GL_MAX_ARRAY_TEXTURE_LAYERS"]), BYTES_MOST // size)
        if needed > most:
            raise LimitError("visibility.directions", f"this view needs {needed:,} layers at once", f"at most {most:,}")
        room = min(max(needed, BYTES_KEPT // size), most, 6 * self._directions)
        if self._layers is not None:
            self._layers.release()
            self._depths.release()
        shape = (self._texels, self._texels, room)
        self._layers = self._gl.ctx.texture_array(shape, 1, dtype="u4", alignment=1)
        self._depths = self._gl.ctx.texture_array(shape, 1, dtype="u2", alignment=1)
        self._where[:] = -1
        self._holds, self._asked = [None] * room, np.zeros(room, np.int64)
