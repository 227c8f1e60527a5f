"""Every order of shells against the exact one, and how long SXMPVO sorts: Dufort 2005, figures 4.3 to 4.6, as a page.

Each scene is drawn once a technique, with the thesis' even samples, which no order moves, and compared with the walk
along each ray, whose order is exact.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from matplotlib.figure import Figure

from renderer.core.registry import phenomenon, techniques
from renderer.shells.order_bench import sort_times
from renderer.shells.order_errors import STEP, order_error
from renderer.study.charts import COLOURS, MARKERS, save
from renderer.study.sweep import provenance

if TYPE_CHECKING:
    from renderer.session import Session

EXACT = "walk"
"""The order that all are held to."""

SETTING: Mapping[str, Any] = {
    "sampling": {"kind": "uniform", "samples": 8},
    "view": {"background": "none"},
    "quality": {"kind": "draft"},
}
"""What is the same in all pictures."""

FILES = ("table.md", "results.json", "orders.png", "orders.svg", "sorting.png", "sorting.svg")
"""What the documentation keeps."""

FLOOR = 1e-5
"""Shares below this are drawn here."""

Tell = Callable[[float, str], None]


def presets_of() -> tuple[str, ...]:
    """The scenes: all presets that stand alone."""
    return tuple(name for name, preset in phenomenon("shells").presets.items() if not preset.group)


def measure(session: Session, presets: Sequence[str], size: int, tell: Tell | None = None) -> dict[str, Any]:
    """Draw every scene by every order.

    Args:
        presets: names. size: side of the pictures [px]. tell: told the share done.

    Returns:
        `errors`, one line a scene and order with the fields of `OrderError` and `milliseconds` on the GL thread;
        `sorting`, the rows of `sort_times`; `machine`, `size`.
    """
    orders = [kind for kind in techniques("shells", "order") if kind != EXACT]
    lines = []
    for number, preset in enumerate(presets):
        if tell is not None:
            tell(number / len(presets), preset)

        def drawn(kind: str, preset: str = preset) -> Any:
            return session.render(session.state("shells", preset, {**SETTING, "order": {"kind": kind}}), size, size)

        exact = drawn(EXACT)
        for kind in orders:
            picture = drawn(kind)
            error = asdict(order_error(picture.linear, exact.linear))
            lines.append({"preset": preset, "order": kind, **error, "milliseconds": picture.render_ms})
    return {
        "errors": lines,
        "sorting": sort_times(),
        "machine": provenance(session.gl.info.renderer),
        "size": size,
    }


def table(found: Mapping[str, Any]) -> str:
    """The page's text."""
    lines, machine = found["errors"], found["machine"]
    orders = list(dict.fromkeys(line["order"] for line in lines))
    rows = [["scene", *(f"`{kind}`" for kind in orders)], ["---"] + ["---:"] * len(orders)]
    for preset in dict.fromkeys(line["preset"] for line in lines):
        own = {line["order"]: line for line in lines if line["preset"] == preset}
        rows.append([f"`{preset}`", *(f"{100 * own[k]['wrong']:.2f} ({own[k]['relative_rmse']:.2g})" for k in orders)])
    sorting = [["cells", "relations", "given by pixels alone", "ms"], ["---:"] * 4]
    sorting += [
        [f"{row['cells']:,}", f"{row['relations']:,}", f"{row['of_pixels']:,}", f"{row['ms']:.1f}"]
        for row in found["sorting"]
    ]
    return (
        f"Orders of shells: {machine['renderer']}, {machine['cores']} cores\n\n"
        f"Wrong pixels in per cent (in brackets: relative RMSE) against the exact order of `{EXACT}`, "
        f"{found['size']} px a side, one sample a pixel, 8 even samples a cell. A pixel is wrong that differs by more "
        f"than {STEP:.4f} of "
        f"the brightest light.\n\n{_markdown(rows)}\n"
        "SXMPVO on a hollow sphere of more and more cells, CPU time of one sort (Dufort 2005, figure 4.6):\n\n"
        f"{_markdown(sorting)}"
    )


def orders_chart(found: Mapping[str, Any]) -> Figure:
    """Share of wrong pixels of each order, a mark a scene."""
    lines = found["errors"]
    orders = list(dict.fromkeys(line["order"] for line in lines))
    figure = Figure(figsize=(7.5, 4.2), layout="constrained")
    axes = figure.subplots()
    for number, kind in enumerate(orders):
        shares = sorted(max(line["wrong"], FLOOR) for line in lines if line["order"] == kind)
        across = [number + 0.5 * (place / max(len(shares) - 1, 1) - 0.5) for place in range(len(shares))]
        axes.scatter(across, shares, color=COLOURS[number % len(COLOURS)], marker=MARKERS[number % len(MARKERS)], s=28)
    axes.set_yscale("log")
    axes.set_xticks(range(len(orders)), orders, rotation=20)
    axes.set_ylabel(f"share of wrong pixels (none: {FLOOR:g})")
    axes.grid(axis="y", alpha=0.3)
    return figure


def sorting_chart(found: Mapping[str, Any]) -> Figure:
    """Time of one sort against the number of cells."""
    figure = Figure(figsize=(6, 4), layout="constrained")
    axes = figure.subplots()
    cells, spent = ([row[key] for row in found["sorting"]] for key in ("cells", "ms"))
    axes.plot(cells, spent, marker="o", color=COLOURS[0])
    axes.set(xscale="log", yscale="log", xlabel="cells", ylabel="CPU time of one sort, ms")
    axes.grid(which="both", alpha=0.3)
    return figure


def write(found: Mapping[str, Any], folder: Path) -> str:
    """Write `FILES`, and return the page's text."""
    folder.mkdir(parents=True, exist_ok=True)
    text = table(found)
    (folder / "table.md").write_text(text, encoding="utf-8")
    (folder / "results.json").write_text(json.dumps(found, indent=1), encoding="utf-8")
    for name, figure in (("orders", orders_chart(found)), ("sorting", sorting_chart(found))):
        save(figure, folder, name)
    return text


def _markdown(rows: Sequence[Sequence[str]]) -> str:
    return "".join("| " + " | ".join(row) + " |\n" for row in rows)
