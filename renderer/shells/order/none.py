"""No order: cells are drawn as they are stored."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Literal

import moderngl
import numpy as np

from renderer.core.params import param
from renderer.shells.raster import UNDER, composing, gather_source, placed_values, seen_faces, switched
from renderer.shells.technique import OrderTechnique

if TYPE_CHECKING:
    from renderer.gl.program import AnyTexture
    from renderer.shells.frame import Frame


class NoOrder(OrderTechnique):
    """Cells as they are stored: right where a depth buffer is enough, which is where matter is opaque."""

    title: ClassVar[str] = "None"
    caption: ClassVar[str] = "Cells as they are stored: right where matter is opaque and a depth buffer enough."
    paper: ClassVar[str] = ""

    kind: Literal["none"] = "none"
    depth: bool = param(
        True,
        label="Depth buffer",
        help="Whether what a cell shows hides what lies behind it; else all cells are blended as they come.",
        cost="build",
    )
    cut: float = param(0.5, label="Cut", help="Opacity from which a cell's matter counts as opaque.", ge=0.01, le=0.99)

    def picture(self, frame: Frame) -> tuple[Any, dict[str, AnyTexture], dict[str, Any]]:
        """Draw all cells once."""
        rasters = frame.renderer.rasters
        cells, canvas = rasters.cells(frame), rasters.canvas(frame)
        cells.arrange(np.arange(cells.count), seen_faces(frame))
        rasters.said["veiled"] = veiled(frame.arrays["texture"]["colour"])
        canvas.into_gathered.use()
        canvas.into_gathered.depth_mask = self.depth
        with switched(rasters.gl, moderngl.DEPTH_TEST | moderngl.CULL_FACE, None if self.depth else UNDER):
            cells.draw(gather_source(frame.state), frame.textures, placed_values(frame))
        return composing(frame, canvas)


def veiled(colour: np.ndarray) -> float:
    """Share of a texture's matter (K, J, I, 4) that light passes in part: this order is right only where it is 0."""
    opacity = colour[..., 3]
    matter = opacity > 1 / 255
    return float((opacity[matter] < 254 / 255).mean()) if matter.any() else 0.0
