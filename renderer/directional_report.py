"""Tables and charts of `renderer.directional_study`, beside its raw results."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from renderer import directional_settings as settings
from renderer import directional_study as study
from renderer.study.charts import COLOURS, MARKERS
from renderer.study.sweep import read

if TYPE_CHECKING:
    from renderer.session import Session

Lines = list[dict[str, Any]]
CHARTS = ("chief", "faces", "codes", "silhouettes")
FILES = ("table.md", *(f"{name}.{kind}" for name in CHARTS for kind in ("png", "svg")))
"""What the documentation keeps."""

NAMES = ("texels", "directions", "selection", "code", "size", "blend", "shadow_directions", "points")
"""Of what a setting varies."""


def run(
    session: Session, presets: Sequence[str], folder: Path, views: int, suns: int, parts: Sequence[str],
    tell: Callable[[float, str], None],
) -> str:  # fmt: skip
    """Measure what is not measured yet, and write table and charts of all there is of some presets.

    Args:
        session: draws, bakes and caches. presets: of the scene. folder: of the files.
        views, suns: how many. parts: of `PARTS`. tell: told the share done; may raise `Cancelled`, and table and
            charts are then of what there is.

    Returns:
        The table.
    """
    folder.mkdir(parents=True, exist_ok=True)
    results = folder / "results.jsonl"
    try:
        for turn, preset in enumerate(presets):
            stage = study.Stage(session, preset, results, views, suns)
            try:
                for number, part in enumerate(parts):
                    begun = turn * len(parts) + number
                    share = lambda done, words, first=begun: tell((first + done) / len(parts) / len(presets), words)  # noqa: E731
                    PARTS[part](stage, share)
            finally:
                stage.partial.close()
    finally:
        text = write(folder, [line for line in read(results) if line["preset"] in presets])
    return text


PARTS: Mapping[str, Callable[[study.Stage, Callable[[float, str], None]], Lines]] = {
    "chief": lambda stage, tell: stage.swept("chief", settings.CHIEF, tell),
    "faces": lambda stage, tell: stage.swept("faces", settings.FACES, tell),
    "codes": lambda stage, tell: stage.swept("codes", settings.CODES, tell),
    "finer": study.finer,
    "silhouettes": lambda stage, tell: stage.outlines(settings.OUTLINES, tell),
}


def write(folder: Path, lines: Lines) -> str:
    """Table and charts of some results; where a case was measured twice, the later counts."""
    latest = {tuple(line[name] for name in (*NAMES, "part", "preset", "view", "sun")): line for line in lines}
    parts = {name: [line for line in latest.values() if line["part"] == name] for name in
             ("chief", "faces", "codes", "silhouette", "finer")}  # fmt: skip
    for name, figure in (
        ("chief", _chief(parts["chief"])),
        ("faces", _by_directions(parts["faces"], ("away",), "relative RMSE away from silhouettes, median")),
        ("silhouettes", _by_directions(parts["silhouette"], ("median", "p95"), "pixels off, box of 400 pixels")),
        ("codes", _codes(parts["codes"])),
    ):
        FigureCanvasAgg(figure)
        if not figure.axes:
            figure.text(0.5, 0.5, "not measured", ha="center")
        figure.savefig(folder / f"{name}.png", dpi=100, metadata={"Software": None})
        figure.savefig(folder / f"{name}.svg", metadata={"Date": None})
    text = table(parts)
    (folder / "table.md").write_text(text, encoding="utf-8")
    return text


def table(parts: Mapping[str, Lines]) -> str:
    """All of it as Markdown."""
    some = next((lines for lines in parts.values() if lines), [])
    machine = some[0]["machine"] if some else {"renderer": "nothing measured", "cores": 0}
    text = [
        f"Directional textures against their reference: {study.SIZE} px, {machine['renderer']}, "
        f"{machine['cores']} cores\n",
        f"Converged pictures at the reference's {study.POSITIONS} positions a pixel. *Away*: over pixels farther than "
        "a hundredth of the box's longest side from true silhouettes, before the sky or before the subject itself, "
        "relative to their mean. Median and worst over views and suns.\n",
    ]
    for preset in sorted({line["preset"] for lines in parts.values() for line in lines}):
        text.append(f"## {preset.capitalize()}\n")
        for title, part, made in SECTIONS:
            own = [line for line in parts[part] if line["preset"] == preset]
            text += [f"### {title}\n", made(own)] if own else []
    return "\n".join(text)


def groups(lines: Lines) -> list[tuple[tuple[Any, ...], Lines]]:
    """Lines by setting, in the order of their settings."""
    found: dict[tuple[Any, ...], Lines] = {}
    for line in lines:
        found.setdefault(tuple(line[name] for name in NAMES), []).append(line)
    return sorted(found.items(), key=lambda item: tuple(map(str, item[0][3:])) + (item[0][2], item[0][0], item[0][1]))


def said(setting: Sequence[Any]) -> list[str]:
    """The cells of a setting."""
    texels, directions, selection, code, size, blend, shadow, points = setting
    extra = (f", {size} bytes" if size else "") + ("" if blend is None else ", blended" if blend else ", nearest")
    return [str(texels), f"{directions:,}", selection, code + extra, f"{shadow:,}", f"{points:,}"]


HEAD = ["texels", "directions", "selection", "code", "of light", "points"]


def _errors(lines: Lines) -> str:
    rows = []
    for setting, own in groups(lines):
        away = [line["away"] for line in own if line["away"] is not None]
        whole = [line["relative_rmse"] for line in own]
        most = [line["most"] for line in own if line.get("most") is not None] or [float("nan")]
        rows.append([*said(setting), f"{np.median(away):.3f}", f"{max(away):.3f}", f"{np.median(most):.3f}",
                     f"{np.median(whole):.3f}",
                     f"{np.median([line['flip_mean'] for line in own]):.4f}",
                     f"{np.median([line['flip_p95'] for line in own]):.3f}", str(len(own))])  # fmt: skip
    heads = ["away, median", "worst", "without the worst 2 %", "whole, median", "FLIP, mean", "95 %", "pictures"]
    return _markdown([*HEAD, *heads], rows)


def _silhouettes(lines: Lines) -> str:
    rows = []
    for setting, own in groups(lines):
        middle, far = ([line[name] for line in own] for name in ("median", "p95"))
        rows.append([*said(setting)[:3], f"{np.median(middle):.2f}", f"{max(middle):.2f}", f"{np.median(far):.2f}",
                     f"{max(far):.2f}", str(len(own))])  # fmt: skip
    heads = ["median, middle view", "worst view", "95 %, middle view", "worst view", "views"]
    return _markdown([*HEAD[:3], *heads], rows)


def _finer(lines: Lines) -> str:
    rows = []
    for title, name in (
        ("FLIP between the two, mean", "between_mean"), ("FLIP between the two, 95 %", "between_p95"),
        ("relative RMSE between the two", "between"), ("129, away from silhouettes, to the reference", "coarse"),
        ("513, away from silhouettes, to the reference", "fine"),
    ):  # fmt: skip
        values = [line[name] for line in lines if line[name] is not None]
        if values:
            rows.append([title, f"{np.median(values):.4f}", f"{max(values):.4f}", str(len(values))])
    return _markdown(["129 against 513", "median", "worst", "pictures"], rows)


def _markdown(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [heads, ["---"] * len(heads), *rows]
    return "".join("| " + " | ".join(line) + " |\n" for line in lines)


SECTIONS: tuple[tuple[str, str, Callable[[Lines], str]], ...] = (
    ("As it comes, and what errs least", "chief", _errors),
    ("What the faces know", "faces", _errors),
    ("What a point knows of its shadow", "codes", _errors),
    (f"Silhouettes: pixels off, both ways, the box {study.BOX} px long", "silhouette", _silhouettes),
    ("129 or 513 directions of light", "finer", _finer),
)


def _chief(lines: Lines) -> Figure:
    """Every picture's error, sorted, by preset and setting."""
    figure = Figure(figsize=(8, 4.5), layout="constrained")
    axes = figure.add_subplot(yscale="log", xlabel="pictures, from the best to the worst [%]",
                              ylabel="relative RMSE away from silhouettes")  # fmt: skip
    for colour, preset in zip(COLOURS, sorted({line["preset"] for line in lines})):
        for style, (setting, own) in zip(("-", "--", ":"), groups([one for one in lines if one["preset"] == preset])):
            error = np.sort([line["away"] for line in own if line["away"] is not None])
            share = 100 * (np.arange(len(error)) + 0.5) / len(error)
            axes.plot(share, error, style, color=colour, label=f"{preset}: {', '.join(said(setting)[:5])}")
    axes.axhline(0.1, color="grey", linewidth=0.8)
    axes.grid(True, alpha=0.2, which="both")
    if lines:
        axes.legend(fontsize="x-small")
    return figure


def _by_directions(lines: Lines, names: Sequence[str], what: str) -> Figure:
    """A panel for each preset and number, a line for each selection and number of texels, against the directions."""
    panels = [(preset, name) for preset in sorted({line["preset"] for line in lines}) for name in names]
    figure = Figure(figsize=(6.5 * max(len(panels), 1), 4.5), layout="constrained")
    for column, (preset, name) in enumerate(panels):
        axes = figure.add_subplot(1, len(panels), column + 1, xscale="log", yscale="log", ylabel=what,
                                  xlabel="directions of a face",
                                  title=f"{preset}: {name}" if len(names) > 1 else preset)  # fmt: skip
        for colour, selection in zip(COLOURS, settings.SELECTIONS):
            for marker, texels in zip(MARKERS, (64, 128, 256)):
                wanted = (preset, selection, texels)
                own = [line for line in lines if (line["preset"], line["selection"], line["texels"]) == wanted]
                steps = sorted({line["directions"] for line in own})
                values = [np.median([line[name] for line in own if line["directions"] == step
                                     and line[name] is not None]) for step in steps]  # fmt: skip
                if steps:
                    axes.plot(steps, values, f"-{marker}", color=colour, label=f"{selection}, {texels}", alpha=0.8)
        axes.grid(True, alpha=0.2, which="both")
        axes.legend(fontsize="x-small")
    return figure


def _codes(lines: Lines) -> Figure:
    """Error of each code, darkest first, a panel for each preset."""
    presets = sorted({line["preset"] for line in lines})
    figure = Figure(figsize=(8 * max(len(presets), 1), 5), layout="constrained")
    for column, preset in enumerate(presets):
        axes = figure.add_subplot(1, len(presets), column + 1, title=preset, xlabel="relative RMSE away from "
                                  "silhouettes: median, and the middle half")  # fmt: skip
        rows = [(", ".join([said(setting)[3], f"{said(setting)[4]} directions"]),
                 np.percentile([line["away"] for line in own if line["away"] is not None], [25, 50, 75]))
                for setting, own in groups([line for line in lines if line["preset"] == preset])]  # fmt: skip
        rows.sort(key=lambda row: -row[1][1])
        for place, (_, (low, middle, high)) in enumerate(rows):
            axes.plot([low, high], [place, place], color=COLOURS[0], alpha=0.5)
            axes.plot(middle, place, "o", color=COLOURS[0])
        axes.set_yticks(range(len(rows)), [name for name, _ in rows], fontsize="small")
        axes.grid(True, alpha=0.2)
    return figure
