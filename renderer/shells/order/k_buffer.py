"""Order by a window of a few cells in each pixel."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Literal

from renderer.core.params import param
from renderer.shells.raster import composing
from renderer.shells.technique import OrderTechnique
from renderer.shells.window import draw_through_windows, moved_by, nearest_first, sorted_before

if TYPE_CHECKING:
    from renderer.gl.program import AnyTexture
    from renderer.shells.frame import Frame


class KBuffer(OrderTechnique):
    """Cells roughly sorted on the CPU, and put right in each pixel as far as they are at most k places out of order.

    Two triangles of a pixel must not be drawn at once: software rendering keeps to that, elsewhere a race may lose one.
    """

    title: ClassVar[str] = "K-buffer"
    caption: ClassVar[str] = "Cells roughly sorted on the CPU; each pixel sorts the next k anew: wrong beyond that."
    paper: ClassVar[str] = "Callahan, Ikits, Comba & Silva 2005; Dufort 2005, section 4.3.1"
    requires: ClassVar[tuple[int, int]] = (4, 3)

    kind: Literal["k_buffer"] = "k_buffer"
    k: int = param(4, label="k", help="Cells in a pixel's window.", cost="build", unit="count", ge=1, le=32)
    presort: Literal["middles", "sxmpvo"] = param(
        "middles",
        label="Rough order",
        help="By the cells' middles; or SXMPVO's of a while ago, as long as the camera has moved little.",
        cost="host",
        source="Dufort 2005, section 4.3.1",
    )
    drift: float = param(
        5.0,
        label="Drift",
        help="How far the camera may move, seen from the shell, before SXMPVO sorts anew.",
        unit="deg",
        cost="host",
        ge=0,
        le=180,
    )

    def picture(self, frame: Frame) -> tuple[Any, dict[str, AnyTexture], dict[str, Any]]:
        """Draw all cells through the windows, then what is left in them."""
        rasters = frame.renderer.rasters
        cells, canvas = rasters.cells(frame), rasters.canvas(frame)
        order = nearest_first(frame) if self.presort == "middles" else sorted_before(frame, self.drift)
        wrong = draw_through_windows(frame, cells, canvas, order, self.k)
        rasters.said |= {"out_of_order": wrong, "drift": moved_by(frame)}
        return composing(frame, canvas)
