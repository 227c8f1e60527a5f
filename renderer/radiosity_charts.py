"""Charts of `renderer.radiosity_study`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from renderer import radiosity_study as study
from renderer.clouds.radiosity import numbers
from renderer.clouds.radiosity.bases import HALF
from renderer.clouds.radiosity.two_planes import solve
from renderer.study.charts import COLOURS, plain_axes

Lines = list[dict[str, Any]]
SCENES = ("uniform", "square", "cone", "ring")
SHOWN = (
    "fft",
    "three_level (taps)",
    "transfer object 64",
    "transfer object 256",
    "transfer solid_angle 256",
    "transfer haar 64",
    "transfer haar 256",
    "transfer haar 64, gathered",
)
"""Whose profiles are drawn."""


def profiles(title: str, fields: Mapping[str, Sequence[np.ndarray]]) -> Figure:
    """Radiosity of ground and base along the middle of the square, truth and techniques."""
    figure = Figure(figsize=(11, 7), layout="constrained")
    places = (np.arange(study.FINE) + 0.5) * 2 * HALF / study.FINE - HALF
    for k, side in enumerate(("ground", "cloud base")):
        axes = figure.add_subplot(
            2,
            1,
            k + 1,
            title=f"{title}: {side}",
            xlabel="place, heights of the cloud base",
            ylabel="radiosity over the cloud's first",
        )
        axes.plot(places, _section(fields["truth"][k]), color="black", linewidth=6, alpha=0.25, label="truth")
        for colour, name in zip(COLOURS, SHOWN):
            axes.plot(places, _section(fields[name][k]), color=colour, linewidth=1.1, label=name)
        axes.axvspan(-HALF, -HALF / 2, color="grey", alpha=0.12)
        axes.axvspan(HALF / 2, HALF, color="grey", alpha=0.12)
        axes.grid(True, alpha=0.2)
        axes.legend(fontsize="small", loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def _section(field: np.ndarray) -> np.ndarray:
    middle = len(field) // 2
    return np.asarray(field[middle - 1 : middle + 1].mean(axis=0))


def errors_chart(lines: Lines) -> Figure:
    """Errors by coefficients in each scene: against the basis' cells, place by place, and the basis' own floor."""
    figure = Figure(figsize=(14, 7), layout="constrained")
    for row, side in enumerate(("ground", "cloud")):
        for column, scene in enumerate(SCENES):
            axes = figure.add_subplot(
                2,
                4,
                4 * row + column + 1,
                xscale="log",
                yscale="log",
                title=f"{scene}: {side}",
                xlabel="coefficients",
                ylabel="relative RMSE",
            )
            for colour, basis in zip(COLOURS, study.BASES):
                own = [line for line in lines if line["scene"] == scene and line["technique"] == f"transfer {basis}"]
                counts = [line["coefficients"] for line in own]
                for name, style in (("cells", "-o"), ("pointwise", "--s"), ("floor", ":")):
                    values = [line[side][name] for line in own]
                    axes.plot(counts, values, style, color=colour, markersize=4, label=f"{basis}: {name}")
            axes.axhline(0.03, color="black", linewidth=0.8)
            plain_axes(axes)
            axes.set_xticks(list(study.COUNTS))
    axes.legend(fontsize="small", loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def cut_chart() -> Figure:
    """Error of planes cut to discs, after 4 bounces (Belcour 2009, figures A.1 to A.6)."""
    figure = Figure(figsize=(8.5, 5), layout="constrained")
    axes = figure.add_subplot(
        yscale="log",
        xlabel="distance from the axis over the disc's radius",
        ylabel="error, 4 bounces",
        title="Planes cut to a disc: albedos 0.3 and 0.9 (the distance of the planes scales away)",
    )
    for colour, radius in zip(COLOURS, (4, 8, 10, 16, 32)):
        found = solve(numbers.GROUND, numbers.CLOUD, radius, 4, np.linspace(0, radius, 161))
        axes.plot(found.radii / radius, -found.ground_error[-1], color=colour, label=f"{radius}H, ground")
        axes.plot(found.radii / radius, -found.cloud_error[-1], "--", color=colour, label=f"{radius}H, cloud")
    axes.grid(True, which="both", alpha=0.2)
    axes.legend(fontsize="small", loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def slopes_chart() -> Figure:
    """Error of flat ground for the light that ground sends to ground (Belcour 2009, figure 5.3)."""
    figure = Figure(figsize=(7.5, 4.5), layout="constrained")
    axes = figure.add_subplot(
        xlabel="slope, degrees", ylabel="relative error", title="Ground taken for cloud: albedos 0.3 and 0.9"
    )
    angles = np.linspace(0, np.pi / 2, 91)
    for colour, (name, share) in zip(
        COLOURS,
        (
            ("half-bowl of the thesis", numbers.half_bowl),
            ("plane slope", numbers.plane_slope),
            ("valley all round", numbers.valley),
        ),
    ):
        axes.plot(np.degrees(angles), numbers.ground_ground_error(share(angles)), color=colour, label=name)
    axes.grid(True, alpha=0.2)
    axes.legend()
    return figure


def ridges_chart(lines: Lines) -> Figure:
    """Error of level ground for the light of the base over a sunlit ridge (Belcour 2009, figure 5.5)."""
    figure = Figure(figsize=(11, 4.5), layout="constrained")
    for k, (name, fixed, words) in enumerate(
        (("slope", "half_width", "half width 1H"), ("half_width", "slope", "slope 25°"))
    ):
        value = {"half_width": 1.0, "slope": 25.0}[fixed]
        axes = figure.add_subplot(
            1,
            2,
            k + 1,
            xlabel="elevation of the sun, degrees",
            ylabel="relative error",
            title=f"A ridge under the cloud, {words}",
        )
        own = [line for line in lines if line[fixed] == value]
        for colour, wanted in zip(COLOURS, sorted({line[name] for line in own})):
            points = [(line["sun"], line["error"]) for line in own if line[name] == wanted]
            axes.plot(
                *zip(*points),
                "-o",
                color=colour,
                markersize=4,
                label=f"{wanted:g}°" if name == "slope" else f"half width {wanted:g}H",
            )
        axes.grid(True, alpha=0.2)
        axes.legend()
    return figure
