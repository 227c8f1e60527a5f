"""Order by lists that each pixel sorts for itself."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Literal

from renderer.core.params import param
from renderer.shells.lists import draw_lists
from renderer.shells.raster import composing
from renderer.shells.technique import OrderTechnique

if TYPE_CHECKING:
    from renderer.gl.program import AnyTexture
    from renderer.shells.frame import Frame


class FragmentLists(OrderTechnique):
    """Every pixel keeps all cells that it sees, and sorts them: exact, cycles do no harm, memory grows with depth."""

    title: ClassVar[str] = "Fragment lists"
    caption: ClassVar[str] = "Every pixel lists the cells that it sees and sorts them: exact; memory grows with depth."
    paper: ClassVar[str] = "Yang, Hensley, Gruen & Thibieroz 2010"
    requires: ClassVar[tuple[int, int]] = (4, 3)

    kind: Literal["fragment_lists"] = "fragment_lists"
    most: int = param(
        12_000_000,
        label="Most fragments",
        help="Of a picture, at eight bytes each; more are refused.",
        cost="host",
        unit="count",
        ge=1000,
        le=100_000_000,
    )

    def picture(self, frame: Frame) -> tuple[Any, dict[str, AnyTexture], dict[str, Any]]:
        """Count, fill and sort the lists."""
        rasters = frame.renderer.rasters
        cells, canvas = rasters.cells(frame), rasters.canvas(frame)
        fragments, longest = draw_lists(frame, cells, canvas, self.most)
        rasters.said |= {"fragments": fragments, "longest": longest}
        return composing(frame, canvas)
