"""No order but an estimate of what lies in front, from moments of depth."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from renderer.core.params import param
from renderer.shells.absorbance import draw_by_moments
from renderer.shells.raster import composing
from renderer.shells.technique import OrderTechnique

if TYPE_CHECKING:
    from renderer.gl.program import AnyTexture
    from renderer.shells.frame import Frame


class Moments(OrderTechnique):
    """Cells in any order: five sums a pixel say about how much lies before each; opacity is exact, colours are not."""

    title: ClassVar[str] = "Moments"
    caption: ClassVar[str] = "Unsorted: five sums a pixel tell how much lies in front. Exact opacity, near colours."
    paper: ClassVar[str] = "Münstermann, Krumpen, Klein & Peters 2018"

    kind: Literal["moments"] = "moments"
    overestimation: float = param(
        0.25,
        label="Own share",
        help="Of a cell's own absorbance that counts as lying before it.",
        ge=0,
        le=1,
        source="Münstermann et al. 2018, section 3.4",
    )
    bias: float = param(
        5e-7,
        label="Bias",
        help="How far the moments are moved towards those of even matter, against rounding.",
        ge=1e-8,
        le=1e-2,
        source="Münstermann et al. 2018, table 1",
    )

    def picture(self, frame: Frame) -> tuple[Any, dict[str, AnyTexture], dict[str, Any]]:
        """Sum the moments, then the cells' light by what they let through."""
        rasters = frame.renderer.rasters
        cells, canvas = rasters.cells(frame), rasters.canvas(frame)
        draw_by_moments(frame, cells, canvas, np.arange(cells.count))
        return composing(frame, canvas)
