"""The chart of a failure whose symptom is a number: what fails, what survives, and the truth where there is one."""

from __future__ import annotations

import io
from typing import Any

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from renderer.core.failure import Charted, ChartedFailure
from renderer.study.charts import COLOURS

SIZE, DPI = (6.4, 3.0), 100
"""Inches and dots an inch."""

LINES: dict[str, dict[str, Any]] = {
    "truth": {"color": "black", "linewidth": 5.0, "alpha": 0.25},
    "failing": {"color": COLOURS[1], "linewidth": 1.6},
    "surviving": {"color": COLOURS[0], "linewidth": 1.6},
}


def failure_chart(case: ChartedFailure, found: Charted) -> bytes:
    """A PNG; the same results give the same file."""
    figure = Figure(figsize=SIZE, dpi=DPI, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot(xlabel=found.x, ylabel=found.y)
    words = {"failing": case.failing, "surviving": case.surviving, "truth": "truth"}
    for curve in found.curves:
        axes.plot(curve.x, curve.y, label=curve.label or words[curve.part], **LINES[curve.part])
    if "x" in found.log:
        axes.set_xscale("log")
    if "y" in found.log:
        axes.set_yscale("log")
    axes.grid(True, which="both", alpha=0.2)
    axes.legend(fontsize="small")
    held = io.BytesIO()
    figure.savefig(held, format="png", metadata={"Software": None})
    return held.getvalue()
