"""The table of shadow kinds and its chart, from raw results: one row a technique, one column a kind of shadow."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from renderer.core.errors import InputError
from renderer.study.charts import COLOURS, MARKERS, pareto, plain_axes

Lines = Sequence[Mapping[str, Any]]

NAN = float("nan")

MEASURES = ("relative_rmse", "flip_mean", "flicker")
"""Of each kind, as the results name them."""

COSTS = (
    ("frame_ms", "frame, ms"),
    ("yardsticks", "yardsticks"),
    ("held_bytes", "on the GPU, MB"),
    ("baked_bytes", "baked, MB"),
    ("bake_seconds", "bake, s of a core"),
)
"""Of each technique: its name here, and its heading."""

MEGA = 1e6


@dataclass(frozen=True)
class Row:
    """One technique.

    Attributes:
        label: of it.
        kinds: by column, the `MEASURES`; NaN where it could not be drawn.
        costs: by name, as in `COSTS`; NaN where unknown.
        combination: whether it answers for its light too.
    """

    label: str
    kinds: Mapping[str, Mapping[str, float]]
    costs: Mapping[str, float]
    combination: bool


def rows(lines: Lines) -> list[Row]:
    """One row a technique, the most right of all kinds together first, combinations after the rest.

    Args:
        lines: results of one machine: `shadow_kind`, and `time` and `bytes` where they were measured.

    Raises:
        InputError: results of several renderers, or none.
    """
    renderers = {str(line["machine"]["renderer"]) for line in lines}
    if len(renderers) != 1:
        raise InputError("results", f"come from {len(renderers)} renderers", "one: their times do not compare")
    held: dict[str, dict[str, dict[str, float]]] = {}
    combined: dict[str, bool] = {}
    for line in lines:
        if line["kind"] == "shadow_kind":
            found = {name: float(line.get(name, NAN)) for name in MEASURES}
            held.setdefault(line["label"], {})[line["column"]] = found
            combined[line["label"]] = bool(line["combination"])
    costs: dict[str, dict[str, float]] = {label: {} for label in held}
    for line in lines:
        if line["kind"] == "time" and (label := line["techniques"]["contender"]) in costs:
            costs[label] |= {"frame_ms": line["frame_ms"], "yardsticks": line["yardsticks"]}
        elif line["kind"] == "bytes" and line["label"] in costs:
            costs[line["label"]] |= {name: line[name] for name in ("held_bytes", "baked_bytes", "bake_seconds")}
    made = [Row(label, kinds, costs[label], combined[label]) for label, kinds in held.items()]
    return sorted(made, key=lambda row: (row.combination, _order(list(row.kinds.values())[-1]["relative_rmse"])))


def _order(value: float) -> float:
    return value if np.isfinite(value) else np.inf


def columns(made: Sequence[Row]) -> list[str]:
    """Kinds of shadow, in the order of the results."""
    return list(dict.fromkeys(name for row in made for name in row.kinds))


def table(made: Sequence[Row]) -> str:
    """The rows as Markdown; the least error of each kind, combinations apart, is in bold."""
    kinds = columns(made)
    least = {kind: min((_value(row, kind) for row in made if not row.combination), default=NAN) for kind in kinds}
    out = [["technique", *kinds, *(heading for _, heading in COSTS)], ["---", *["---:"] * (len(kinds) + len(COSTS))]]
    for row in made:
        cells = []
        for kind in kinds:
            found = row.kinds.get(kind, {})
            texts = [_number(found.get(name, NAN)) for name in MEASURES]
            if not row.combination and _value(row, kind) == least[kind]:
                texts[0] = f"**{texts[0]}**"
            cells.append(" / ".join(texts))
        out.append([row.label, *cells, *(_cost(row, name) for name, _ in COSTS)])
    return "".join("| " + " | ".join(line) + " |\n" for line in out)


def _value(row: Row, kind: str) -> float:
    return _order(row.kinds.get(kind, {}).get("relative_rmse", NAN))


def _cost(row: Row, name: str) -> str:
    value = row.costs.get(name, NAN)
    return _number(value / MEGA if name.endswith("_bytes") else value)


def _number(value: float) -> str:
    """Three digits, without an exponent."""
    if not np.isfinite(value):
        return "-"
    return f"{value:.0f}" if abs(value) >= 100 else f"{value:.3g}"


def mask_table(lines: Lines) -> str:
    """Share of each view that belongs to its kind, and of each kind in what changes there, as Markdown."""
    masks = [line for line in lines if line["kind"] == "mask"]
    kinds = [line["column"] for line in masks]
    out = [["view", "kind", "pixels that change", *kinds], ["---", "---", *["---:"] * (len(kinds) + 1)]]
    for line in masks:
        shares = [f"{line['shares'][kind]:.0%}" for kind in kinds]
        shares[kinds.index(line["column"])] = f"**{shares[kinds.index(line['column'])]}**"
        out.append([f"`{line['preset']}`", line["column"], f"{line['covers']:.0%}", *shares])
    return "".join("| " + " | ".join(line) + " |\n" for line in out)


def as_csv(made: Sequence[Row]) -> str:
    """The rows as CSV, full precision, bytes as bytes; empty where a value is unknown."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    kinds = columns(made)
    writer.writerow(["technique", *(f"{kind}_{name}" for kind in kinds for name in MEASURES), *(n for n, _ in COSTS)])
    for row in made:
        values = [row.kinds.get(kind, {}).get(name, NAN) for kind in kinds for name in MEASURES]
        values += [row.costs.get(name, NAN) for name, _ in COSTS]
        writer.writerow([row.label, *("" if value != value else value for value in values)])
    return out.getvalue()


def chart(made: Sequence[Row], title: str) -> Figure:
    """Frame time against error, one panel a kind of shadow, one colour a technique, the Pareto front drawn."""
    kinds = columns(made)
    shown = [row for row in made if np.isfinite(row.costs.get("yardsticks", NAN))]
    families = list(dict.fromkeys(_family(row) for row in sorted(shown, key=lambda row: row.label)))
    figure = Figure(figsize=(4.2 * 3, 4.0 * -(-(len(kinds) + 1) // 3)), layout="constrained")
    figure.suptitle(title)
    for place, kind in enumerate(kinds):
        axes = figure.add_subplot(-(-(len(kinds) + 1) // 3), 3, place + 1, xscale="log", yscale="log", title=kind,
                                  xlabel="one frame, the sun moving, yardsticks", ylabel="relative RMSE")  # fmt: skip
        drawn = [row for row in shown if np.isfinite(_value(row, kind)) and _value(row, kind) > 0]
        costs, errors = [row.costs["yardsticks"] for row in drawn], [_value(row, kind) for row in drawn]
        front = sorted(
            pair for pair, on in zip(zip(costs, errors, strict=True), pareto(costs, errors), strict=True) if on
        )
        axes.step([f[0] for f in front], [f[1] for f in front], where="post", color="black", linewidth=1)
        for row, cost, error in zip(drawn, costs, errors, strict=True):
            style = families.index(_family(row))
            axes.plot(cost, error, _marker(style), color=COLOURS[style % len(COLOURS)], markersize=7,
                      markeredgecolor="white", linestyle="none")  # fmt: skip
        plain_axes(axes)
    legend = figure.add_subplot(-(-(len(kinds) + 1) // 3), 3, len(kinds) + 1)
    legend.set_axis_off()
    for style, family in enumerate(families):
        legend.plot([], [], _marker(style), color=COLOURS[style % len(COLOURS)], label=family)
    legend.plot([], [], color="black", linewidth=1, label="Pareto front")
    legend.legend(fontsize="small", loc="upper left")
    return figure


def _family(row: Row) -> str:
    """What has a colour of its own: a technique, whatever its settings."""
    return row.label.split(",")[0]


def _marker(style: int) -> str:
    return MARKERS[style // len(COLOURS) % len(MARKERS)]


def write(lines: Lines, folder: Path, title: str, notes: str) -> list[Row]:
    """Table and chart of some results: `table.md`, and `speed_accuracy` as `.png`, `.svg` and `.csv`.

    Raises:
        InputError: as `rows`.
    """
    made = rows(lines)
    folder.mkdir(parents=True, exist_ok=True)
    text = f"{title}\n\n{notes}\n\n{table(made)}\n{mask_table(lines)}"
    (folder / "table.md").write_text(text, encoding="utf-8")
    (folder / "speed_accuracy.csv").write_text(as_csv(made), encoding="utf-8")
    figure = chart(made, title)
    FigureCanvasAgg(figure)
    figure.savefig(folder / "speed_accuracy.png", dpi=90, metadata={"Software": None})
    figure.savefig(folder / "speed_accuracy.svg", metadata={"Date": None})
    return made
