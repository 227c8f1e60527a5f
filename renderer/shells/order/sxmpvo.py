"""Order by sorting the cells on the CPU."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import moderngl

from renderer.core.params import param
from renderer.shells.order.fragment_lists import FragmentLists
from renderer.shells.raster import UNDER, composing, gather_source, placed_values, seen_faces, switched
from renderer.shells.technique import OrderTechnique
from renderer.shells.visibility import sorted_for

if TYPE_CHECKING:
    from renderer.gl.program import AnyTexture
    from renderer.shells.frame import Frame


class Sxmpvo(OrderTechnique):
    """Cells sorted by which hides which, then drawn once, front to back."""

    title: ClassVar[str] = "SXMPVO"
    caption: ClassVar[str] = "Cells sorted on the CPU by which hides which, then drawn once: exact but for cycles."
    paper: ClassVar[str] = "Cook, Max, Silva & Williams 2004; Dufort 2005, section 4.3"

    kind: Literal["sxmpvo"] = "sxmpvo"
    fineness: float = param(
        1.0,
        label="Fineness",
        help="Pixels a side of the lists that sort what does not touch, against the picture's own.",
        cost="host",
        ge=0.02,
        le=4,
    )

    cycles: Literal["broken", "lists"] = param(
        "broken",
        label="Cycles",
        help="Give up the relation that the fewest pixels show; or draw such a picture by fragment lists (OpenGL 4.3).",
        cost="host",
    )

    def picture(self, frame: Frame) -> tuple[Any, dict[str, AnyTexture], dict[str, Any]]:
        """Sort the cells, unless camera and shell stand as they stood, and draw them."""
        rasters = frame.renderer.rasters
        order = sorted_for(frame, self.fineness)
        rasters.said |= {"relations": order.relations, "cycles": order.cycles, "cyclic": order.cyclic}
        if order.cycles and self.cycles == "lists" and rasters.gl.info.version >= FragmentLists.requires:
            lists = FragmentLists()
            return lists.picture(replace(frame, state=frame.state.model_copy(update={"order": lists})))
        cells, canvas = rasters.cells(frame), rasters.canvas(frame)
        cells.arrange(order.cells, seen_faces(frame))
        canvas.into_gathered.use()
        canvas.into_gathered.depth_mask = False
        with switched(rasters.gl, moderngl.DEPTH_TEST | moderngl.CULL_FACE, UNDER):
            cells.draw(gather_source(frame.state), frame.textures, placed_values(frame))
        return composing(frame, canvas)
