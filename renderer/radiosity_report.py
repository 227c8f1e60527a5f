"""Tables and charts of `renderer.radiosity_study`, and the folder that holds them with the raw results."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from renderer import radiosity_study as study
from renderer.clouds.radiosity import numbers
from renderer.clouds.radiosity.bases import HALF
from renderer.clouds.radiosity.two_planes import solve
from renderer.core.cache import Cache
from renderer.radiosity_failures import CASES
from renderer.study.charts import COLOURS, plain_axes

Lines = list[dict[str, Any]]
SCENES = ("uniform", "square", "cone", "ring")
CHARTS = (*(f"profiles_{scene}" for scene in SCENES), "errors", "cut", "ridges", "slopes")
FILES = ("table.md", "results.jsonl", *(f"{name}.{kind}" for name in CHARTS for kind in ("png", "svg")))
"""What the documentation keeps."""

SHOWN = (
    "fft",
    "three_level (taps)",
    "transfer object 64",
    "transfer object 256",
    "transfer solid_angle 256",
    "transfer haar 64",
    "transfer haar 256",
)
"""Whose profiles are drawn."""


def run(folder: Path, rays: int, tell: Callable[[float, str], None]) -> str:
    """Measure everything, and leave raw results, table and charts in a folder.

    Args:
        folder: made where it is missing.
        rays: of each point of the truth.
        tell: told the share done; may raise `Cancelled`.

    Returns:
        The table.
    """
    folder.mkdir(parents=True, exist_ok=True)
    parts: dict[str, Lines] = {"scenes": []}
    last = None
    for case in study.cases(rays, Cache(), lambda share, words: tell(0.7 * share, words)):
        lines, fields = study.scene_lines(case)
        parts["scenes"] += lines
        _save(folder, f"profiles_{case.scene.name}", profiles(case.scene.title, fields))
        last = case
    assert last is not None
    parts["ridges"] = study.ridge_lines(max(rays // 8, 64), lambda share, words: tell(0.7 + 0.2 * share, words))
    tell(0.9, "numbers of the thesis, failures")
    parts["numbers"] = [number.document() for number in numbers.numbers()]
    ring = last
    parts["failures"] = [failure.document(failure.measure(lambda: ring)) for failure in CASES]
    parts["solving"] = [study.solving_time(squares, count) for squares, count in ((256, 15), (256, 64), (16, 256))]
    with (folder / "results.jsonl").open("w", encoding="utf-8") as file:
        for name, lines in parts.items():
            file.writelines(json.dumps({"part": name, "rays": rays, **line}) + "\n" for line in lines)
    for name, figure in (
        ("errors", errors_chart(parts["scenes"])),
        ("cut", cut_chart()),
        ("slopes", slopes_chart()),
        ("ridges", ridges_chart(parts["ridges"])),
    ):
        _save(folder, name, figure)
    text = table(parts, rays)
    (folder / "table.md").write_text(text, encoding="utf-8")
    return text


def _save(folder: Path, name: str, figure: Figure) -> None:
    FigureCanvasAgg(figure)
    # Without a date, the same results give the same file.
    figure.savefig(folder / f"{name}.png", dpi=100, metadata={"Software": None})
    figure.savefig(folder / f"{name}.svg", metadata={"Date": None})


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


def table(parts: Mapping[str, Lines], rays: int) -> str:
    """All of it as Markdown."""
    sections = [
        f"Light between ground and clouds (`umbrage study clouds --radiosity`). Truth: rays ({rays:,} a point) over "
        "relief, quadrature over level ground. Compute square of side 32H, H = 2,500 m; relative RMSE of the radiosity "
        "over the render square of side 16H: against the truth averaged over the basis' cells, place by place, the "
        "basis' own floor (the truth projected on it), and in means over 2H, to which every technique can be held. "
        "Ground 0.3, cloud 0.9, the ring's mountains 0.8.",
        _scenes(parts["scenes"]),
        "Numbers that must come out, beside what the thesis prints.",
        _numbers(parts["numbers"]),
        "Solving anew for a moved sun, three bands, CPU time of one core.",
        _rows(
            ("squares", "coefficients", "prepared, ms", "solved anew, ms"),
            [
                [
                    f"{line['squares']}",
                    f"{line['coefficients']}",
                    f"{line['prepare_ms']:.0f}",
                    f"{line['solve_ms']:.1f}",
                ]
                for line in parts["solving"]
            ],
        ),
        "Failures.",
        _rows(
            ("case", "failing", "surviving", "symptom", "failing now", "threshold", "surviving now"),
            [
                [
                    line["title"],
                    line["failing"],
                    line["surviving"],
                    line["symptom"],
                    f"{line['failing_now']:.4f}",
                    f"{line['threshold']:g}",
                    f"{line['surviving_now']:.4f}",
                ]
                for line in parts["failures"]
            ],
        ),
    ]
    return "\n\n".join(sections) + "\n"


def _rows(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = ["| " + " | ".join(heads) + " |", "| --- " + "| ---: " * (len(heads) - 1) + "|"]
    return "\n".join([*lines, *("| " + " | ".join(row) + " |" for row in rows)])


def _scenes(lines: Lines) -> str:
    heads = [
        "scene",
        "technique",
        *(
            f"{side}: {name}"
            for side in ("ground", "cloud")
            for name in ("cells", "pointwise", "floor", "ratio", "means over 2H")
        ),
    ]
    rows = []
    for line in lines:
        name = f"{line['technique']} {line['coefficients']}" if "coefficients" in line else line["technique"]
        cells = [
            _share(line[side].get(key)) if key != "ratio" else _ratio(line[side].get(key))
            for side in ("ground", "cloud")
            for key in ("cells", "pointwise", "floor", "ratio", "blocks")
        ]
        rows.append([line["scene"], name, *cells])
    return _rows(heads, rows)


def _share(value: float | None) -> str:
    return "-" if value is None else f"{100 * value:.3g} %"


def _ratio(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}"


def _numbers(lines: Lines) -> str:
    rows = [
        [
            line["quantity"],
            line["where"],
            line["printed"] or "-",
            f"{line['right']:.6g}",
            f"{line['computed']:.6g}",
            "yes" if line["agrees"] else "NO",
            line["note"] or "-",
        ]
        for line in lines
    ]
    return _rows(("quantity", "section", "printed", "right", "computed", "agrees", "note"), rows)
