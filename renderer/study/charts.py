"""Tables and charts from raw results: one command redraws them, and each chart keeps its numbers beside it."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from renderer.core.errors import InputError
from renderer.study.sweep import read

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#8c6d31", "#999999", "#882255",
           "#332288", "#a3b800")
"""Distinct for colour-blind eyes (Okabe and Ito 2008), their yellow replaced by a brown that shows on white; the last
four after Tol 2021."""

OWN = "relative_rmse_without_noise"

MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*")


@dataclass(frozen=True)
class Point:
    """One combination over all its suns and presets.

    Attributes:
        techniques: kind by slot.
        error, worst: median and worst relative RMSE.
        own, own_worst: the same without the reference's noise; NaN in results that do not tell it.
        flip: median of FLIP's mean.
        gained: median relative RMSE after one gain a picture.
        frame_ms, yardsticks: median interactive frame, the camera at rest; NaN where it was not timed.
        slowest: the same at the preset where it takes most, yardsticks.
        moved: median frame while the camera moves, yardsticks; NaN where it was not timed.
        pairing: worst ratio of one frame's noise to the reference's; NaN where unknown.
        cases: number of results behind the errors.
        on_front: no other combination is both faster and more right.
    """

    techniques: Mapping[str, str]
    error: float
    worst: float
    own: float
    own_worst: float
    flip: float
    gained: float
    frame_ms: float
    yardsticks: float
    slowest: float
    moved: float
    pairing: float
    cases: int
    on_front: bool

    @property
    def name(self) -> str:
        """The kinds, joined."""
        return " + ".join(self.techniques.values())


def pareto(costs: Sequence[float], errors: Sequence[float]) -> list[bool]:
    """Whether each pair is on the front: no other is at most as costly and at most as wrong, and better in one.

    Args:
        costs, errors: of each; a pair that is not finite is never on it.
    """
    pairs = list(zip(costs, errors, strict=True))
    front = []
    for cost, error in pairs:
        beaten = any(c <= cost and e <= error and (c < cost or e < error) for c, e in pairs)
        front.append(bool(np.isfinite(cost) and np.isfinite(error) and not beaten))
    return front


def summarise(lines: Sequence[Mapping[str, Any]]) -> list[Point]:
    """One point a combination of techniques, the most right first.

    Args:
        lines: raw results of one machine; of results for one case, the latest counts.

    Raises:
        InputError: results of several renderers, which never share a chart, or none at all.
    """
    renderers = sorted({str(line["machine"]["renderer"]) for line in lines})
    if len(renderers) != 1:
        raise InputError(
            "results", f"come from {len(renderers)} renderers", "one, as software and hardware times do not compare"
        )
    latest: dict[tuple[Any, ...], Mapping[str, Any]] = {}
    for line in lines:
        if "failed" not in line:
            latest[line["kind"], _of(line), line["preset"], line["sun"], str(line["parameters"]), line["seed"]] = line
    errors: dict[tuple[tuple[str, str], ...], list[Mapping[str, Any]]] = {}
    times: dict[tuple[tuple[str, str], ...], list[Mapping[str, Any]]] = {}
    for line in latest.values():
        (errors if line["kind"] == "error" else times).setdefault(_of(line), []).append(line)
    points = [_point(techniques, found, times.get(techniques, [])) for techniques, found in errors.items()]
    front = pareto([p.frame_ms for p in points], [p.error for p in points])
    points = [Point(**{**vars(p), "on_front": on}) for p, on in zip(points, front, strict=True)]
    return sorted(points, key=lambda p: p.error)


def _of(line: Mapping[str, Any]) -> tuple[tuple[str, str], ...]:
    return tuple(sorted(line["techniques"].items()))


def _point(
    techniques: Sequence[tuple[str, str]], errors: Sequence[Mapping[str, Any]], times: Sequence[Mapping[str, Any]]
) -> Point:
    def middle(lines: Sequence[Mapping[str, Any]], name: str) -> float:
        values = [line[name] for line in lines if line.get(name) is not None]
        return float(np.median(values)) if values else float("nan")

    pairing = [line["pairing"] for line in errors if line.get("pairing") is not None]
    turned = [line for line in times if line["parameters"].get("moves") == "camera"]
    rested = [line for line in times if line not in turned]
    slowest = max((line["yardsticks"] for line in rested if line.get("yardsticks")), default=float("nan"))
    own = [line[OWN] for line in errors if line.get(OWN) is not None]
    return Point(dict(techniques), middle(errors, "relative_rmse"), max(line["relative_rmse"] for line in errors),
                 middle(errors, OWN), max(own, default=float("nan")),
                 middle(errors, "flip_mean"), middle(errors, "relative_rmse_after_gain"), middle(rested, "frame_ms"),
                 middle(rested, "yardsticks"), slowest, middle(turned, "yardsticks"),
                 max(pairing, default=float("nan")), len(errors), False)


COLUMNS: tuple[tuple[str, str], ...] = (
    ("median relative RMSE", "error"), ("worst", "worst"), ("median without the reference's noise", "own"),
    ("its worst", "own_worst"), ("median after one gain", "gained"), ("median FLIP", "flip"),
    ("frame, ms", "frame_ms"), ("yardsticks", "yardsticks"), ("slowest preset", "slowest"),
    ("camera moving", "moved"), ("noise against the reference's", "pairing"),
    ("cases", "cases"))


def table(points: Sequence[Point]) -> str:
    """The points as a Markdown table; combinations on the front are in bold."""
    slots = list(points[0].techniques) if points else []
    rows = [[*slots, *(heading for heading, _ in COLUMNS)]]
    for point in points:
        kinds = [f"**{kind}**" if point.on_front else kind for kind in point.techniques.values()]
        rows.append([*kinds, *(_cell(getattr(point, name)) for _, name in COLUMNS)])
    rows.insert(1, ["---"] * len(slots) + ["---:"] * len(COLUMNS))
    return "".join("| " + " | ".join(row) + " |\n" for row in rows)


def _cell(value: float) -> str:
    if isinstance(value, int):
        return str(value)
    return f"{value:.3g}" if np.isfinite(value) else "-"


def as_csv(points: Sequence[Point]) -> str:
    """The points as CSV, full precision; empty where a value is unknown."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    slots = list(points[0].techniques) if points else []
    names = [name for _, name in COLUMNS]
    writer.writerow([*slots, *names, "on_front"])
    for point in points:
        values = [getattr(point, name) for name in names]
        writer.writerow([*point.techniques.values(), *("" if v != v else v for v in values), int(point.on_front)])
    return out.getvalue()


def speed_accuracy(
    points: Sequence[Point],
    title: str,
    colour_by: str,
    marker_by: str = "",
    reference: tuple[float, float] | None = None,
) -> Figure:
    """Frame time against error, log axes, one colour a technique, the Pareto front drawn.

    Args:
        points: from `summarise`; those without a time are left out.
        title: with the machine's name in it.
        colour_by, marker_by: slots whose techniques get colours and markers.
        reference: milliseconds and relative standard error of the reference's own picture.
    """
    figure = Figure(figsize=(8.5, 5.5), layout="constrained")
    axes = figure.add_subplot(xscale="log", yscale="log", title=title, xlabel="one interactive frame, ms",
                              ylabel="median relative RMSE of the converged picture")
    shown = [p for p in points if np.isfinite(p.frame_ms) and p.frame_ms > 0 and p.error > 0]
    colours = _styles(shown, colour_by, COLOURS)
    markers = _styles(shown, marker_by, MARKERS) if marker_by else {}
    for point in shown:
        marker = markers.get(point.techniques.get(marker_by, ""), "o")
        axes.plot(
            [point.frame_ms] * 2, [point.error, point.worst], color=colours[point.techniques[colour_by]], alpha=0.3
        )
        axes.plot(point.frame_ms, point.error, marker, color=colours[point.techniques[colour_by]], markersize=8,
                  markeredgecolor="black" if point.on_front else "white", linestyle="none")
    front = sorted((p.frame_ms, p.error) for p in shown if p.on_front)
    axes.step(
        [f[0] for f in front], [f[1] for f in front], where="post", color="black", linewidth=1, label="Pareto front"
    )
    for kind, colour in colours.items():
        axes.plot([], [], "o", color=colour, label=f"{colour_by}: {kind}")
    for kind, marker in markers.items():
        axes.plot([], [], marker, color="grey", linestyle="none", label=f"{marker_by}: {kind}")
    if reference is not None:
        axes.plot(
            *reference, "*", color="black", markersize=12, linestyle="none", label="reference: its cost, its own error"
        )
    plain_axes(axes)
    axes.legend(fontsize="small", loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def plain_axes(axes: Axes) -> None:
    """A grid, and plain numbers along two logarithmic axes."""
    for axis in (axes.xaxis, axes.yaxis):
        # plain numbers at 1, 2, 5, 10: matplotlib's own crowd each other where an axis spans less than two decades
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())
    axes.grid(True, which="both", alpha=0.2)


def _styles(points: Sequence[Point], slot: str, palette: Sequence[str]) -> dict[str, str]:
    """A style for each technique of a slot, in the order of their names."""
    kinds = sorted({p.techniques[slot] for p in points})
    return {kind: palette[n % len(palette)] for n, kind in enumerate(kinds)}


def write(
    results: Path,
    folder: Path,
    title: str,
    colour_by: str,
    marker_by: str = "",
    keep: Callable[[Mapping[str, Any]], bool] | None = None,
) -> list[Point]:
    """Redraw the table and the chart of a sweep from its raw results.

    Args:
        results: the JSON lines; `keep` chooses among them.
        folder: gets `table.md`, and `speed_accuracy` as `.png`, `.svg` and `.csv`.
        title, colour_by, marker_by: as `speed_accuracy`.

    Raises:
        InputError: as `summarise`.
    """
    lines = [line for line in read(results) if keep is None or keep(line)]
    points = summarise(lines)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "table.md").write_text(f"{title}\n\n{table(points)}", encoding="utf-8")
    (folder / "speed_accuracy.csv").write_text(as_csv(points), encoding="utf-8")
    costs = [(line["reference_seconds"] * 1e3, line["reference_standard_error"]) for line in lines
             if line.get("reference_seconds") and line.get("reference_standard_error")]
    reference = (float(np.median([c for c, _ in costs])), float(np.median([e for _, e in costs]))) if costs else None
    figure = speed_accuracy(points, title, colour_by, marker_by, reference)
    FigureCanvasAgg(figure)
    # without a date, the same results give the same file
    figure.savefig(folder / "speed_accuracy.png", dpi=120, metadata={"Software": None})
    figure.savefig(folder / "speed_accuracy.svg", metadata={"Date": None})
    return points


def save(figure: Figure, folder: Path, name: str) -> None:
    """Write a chart as PNG and as SVG; the same results give the same files."""
    FigureCanvasAgg(figure)
    figure.savefig(folder / f"{name}.png", dpi=90, metadata={"Software": None})
    with rc_context({"svg.hashsalt": name}):
        figure.savefig(folder / f"{name}.svg", metadata={"Date": None})
