"""Order by peeling layers of depth."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from renderer.core.params import param
from renderer.shells.peeling import peel
from renderer.shells.raster import composing, seen_faces
from renderer.shells.technique import OrderTechnique

if TYPE_CHECKING:
    from renderer.gl.program import AnyTexture
    from renderer.shells.frame import Frame


class DepthPeeling(OrderTechnique):
    """The nearest cell of every pixel, then the nearest behind it, until none is left: as many passes as layers."""

    title: ClassVar[str] = "Depth peeling"
    caption: ClassVar[str] = "Each pass draws all cells and keeps the nearest behind the last one: exact, and slow."
    paper: ClassVar[str] = "Everitt 2001; Dufort 2005, section 4.2"

    kind: Literal["depth_peeling"] = "depth_peeling"
    passes: int = param(
        512, label="Most passes", help="Layers beyond them are left out.", cost="host", unit="count", ge=1, le=4096
    )

    def picture(self, frame: Frame) -> tuple[Any, dict[str, AnyTexture], dict[str, Any]]:
        """Peel the layers, each shaded as it is found."""
        rasters = frame.renderer.rasters
        cells, canvas = rasters.cells(frame), rasters.canvas(frame)
        cells.arrange(np.arange(cells.count), seen_faces(frame))
        rasters.said["passes"] = peel(frame, cells, canvas, self.passes)
        return composing(frame, canvas)
