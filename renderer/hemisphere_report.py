"""Table and charts of `renderer.hemisphere_study`, and the folder that holds them with the raw results."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from renderer import hemisphere_study as study
from renderer.study.charts import COLOURS, MARKERS, save

Lines = list[dict[str, Any]]
FILES = ("table.md", "results.jsonl", "codes.png", "codes.svg", "between.png", "between.svg")
"""What the documentation keeps."""

LIMIT = 0.08
"""Of directions that nine bytes may misjudge."""

FLOOR = 1e-4
"""Shares below this are drawn here."""


def run(folder: Path, mesh: Path | None, points: int, tell: Callable[[float, str], None]) -> str:
    """Measure everything, and leave raw results, table and charts in a folder.

    Args:
        folder: made where it is missing.
        mesh: a file of the user's, as a third cloud. points: of each cloud, about.
        tell: told the share done; may raise `Cancelled`.

    Returns:
        The table.

    Raises:
        InputError: the mesh cannot be used.
    """
    parts = study.measure(mesh, points, tell)
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "results.jsonl").open("w", encoding="utf-8") as file:
        for name, lines in parts.items():
            file.writelines(json.dumps({"part": name, **line}) + "\n" for line in lines)
    text = table(parts)
    (folder / "table.md").write_text(text, encoding="utf-8")
    for name, figure in (("codes", codes_chart(parts["codes"])), ("between", between_chart(parts["between"]))):
        save(figure, folder, name)
    return text


def _names(lines: Lines, key: str = "cloud") -> list[str]:
    return list(dict.fromkeys(line[key] for line in lines))


def codes_chart(lines: Lines) -> Figure:
    """Misjudged directions and rms against bytes, a column a cloud, of 129 directions."""
    lines = [line for line in lines if line["directions"] == 129]
    clouds, codes = _names(lines), _names(lines, "code")
    figure = Figure(figsize=(4.2 * len(clouds), 7.4), layout="constrained")
    axes = figure.subplots(2, len(clouds), sharex=True, sharey="row", squeeze=False)
    for column, cloud in enumerate(clouds):
        for row, key in enumerate(("misjudged", "rms")):
            ax = axes[row, column]
            for number, code in enumerate(codes):
                own = [line for line in lines if line["cloud"] == cloud and line["code"] == code]
                value = [max(line[key], FLOOR if key == "misjudged" else 1e-3) for line in own]
                ax.plot([line["bytes"] for line in own], value, label=code, color=COLOURS[number % len(COLOURS)],
                        marker=MARKERS[number % len(MARKERS)], markersize=5, linewidth=1.2)  # fmt: skip
            ax.set_xscale("log", base=2)
            ax.set_xticks([5, 9, 17, 33], ["5", "9", "17", "33"])
            ax.set_yscale("log")
            ax.grid(True, alpha=0.2)
        axes[0, column].axhline(LIMIT, color="black", linestyle=":", linewidth=1)
        axes[0, column].set_title(cloud)
        axes[1, column].set_xlabel("bytes a point")
    axes[0, 0].set_ylabel("share of directions misjudged (0 drawn at 1e-4)")
    axes[1, 0].set_ylabel("rms of the shadow function (0 at 1e-3)")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=5, fontsize="small")
    return figure


def between_chart(lines: Lines) -> Figure:
    """Misjudged directions by chance against the number of directions of a mask, and of grazing ones."""
    clouds = _names(lines)
    figure = Figure(figsize=(4.2 * len(clouds), 3.8), layout="constrained")
    axes = figure.subplots(1, len(clouds), sharey=True, squeeze=False)[0]
    for ax, cloud in zip(axes, clouds):
        for number, read in enumerate(("nearest", "blended")):
            own = [line for line in lines if line["cloud"] == cloud and line["read"] == read]
            count = [line["directions"] for line in own]
            for key, style in (("misjudged", "-"), ("grazing", "--")):
                label = read if key == "misjudged" else f"{read}, grazing light"
                ax.plot(count, [line[key] for line in own], style, marker="o", markersize=4, label=label,
                        color=COLOURS[number])  # fmt: skip
        ax.set_xscale("log")
        ax.set_xticks([33, 129, 513, 2049], ["33", "129", "513", "2049"])
        ax.minorticks_off()
        ax.set_yscale("log")
        ax.grid(True, which="both", alpha=0.2)
        ax.set_title(cloud)
        ax.set_xlabel("directions of a mask")
    axes[0].set_ylabel("share of random directions misjudged")
    axes[-1].legend(fontsize="small")
    return figure


def table(parts: Mapping[str, Lines]) -> str:
    """All of it as Markdown."""
    codes, clouds = parts["codes"], _names(parts["codes"])
    points = ", ".join(f"{line['cloud']} {line['points']:,}" for line in parts["rays"] if line["directions"] == 129)
    heads = ["code", "bytes", *(f"{cloud}: {name}" for cloud in clouds for name in ("misjudged", "rms"))]
    heads += [f"{clouds[-2]}: {name}" for name in ("ringing", "overshoot", "irradiance")]
    sections = [
        "Codes of shadow hemispheres (`umbrage study directional --hemispheres`). All points of each cloud "
        f"({points}); every direction counts alike, and is misjudged where what is read lies on the other side of a "
        "half. rms is that of the clamped shadow function, ringing the share of values that leave 0 to 1 by more than "
        "a tenth before the clamp, overshoot the worst, irradiance the mean absolute error of an even sky's light.",
        "129 directions. Bits and all harmonics are 17 bytes and exact; `chosen` and `codebook` learn of the cloud.",
        _codes(codes, clouds, heads, 129),
        "513 directions.",
        _codes(codes, clouds, heads, 513),
        f"Between directions: {parts['between'][0]['rays']} random directions of each of "
        f"{parts['between'][0]['points']:,} points, against rays. Codes have nine bytes here, bits (nearest, blended) "
        "and exact_harmonics all. Grazing is light in the lowest row of 129.",
        _rows(
            ("directions", "read", *(f"{c}: {name}" for c in clouds for name in ("misjudged", "grazing", "rms"))),
            _between(parts["between"]),
        ),
        f"Openness against {study.DENSE:,} rays a point, spread by the cosine; the count's own noise is taken off.",
        _rows(
            ("cloud", "directions", "mean difference", "rms"),
            [[o["cloud"], f"{o['directions']}", f"{o['bias']:+.4f}", f"{o['rms']:.4f}"] for o in parts["openness"]],
        ),
        "Rays: CPU time of one core.",
        _rows(
            ("cloud", "directions", "points", "lit", "openness", "µs a point"),
            [
                [r["cloud"], f"{r['directions']}", f"{r['points']:,}", f"{r['lit']:.3f}", f"{r['openness']:.3f}",
                 f"{r['us_a_point']:.1f}"]
                for r in parts["rays"]
            ],
        ),
    ]  # fmt: skip
    return "\n\n".join(sections) + "\n"


def _codes(lines: Lines, clouds: Sequence[str], heads: Sequence[str], directions: int) -> str:
    lines = [line for line in lines if line["directions"] == directions]
    rows = []
    for code, size in dict.fromkeys((line["code"], line["bytes"]) for line in lines):
        own = {line["cloud"]: line for line in lines if (line["code"], line["bytes"]) == (code, size)}
        cells = [text for c in clouds for text in (f"{own[c]['misjudged']:.2%}", f"{own[c]['rms']:.3f}")]
        tree = own[clouds[-2]]
        cells += [f"{tree['ringing']:.1%}", f"{tree['overshoot']:.2f}", f"{tree['irradiance']:.4f}"]
        rows.append([code, str(size), *cells])
    return _rows(heads, rows)


def _between(lines: Lines) -> list[list[str]]:
    rows = []
    for count, read in dict.fromkeys((line["directions"], line["read"]) for line in lines):
        own = [line for line in lines if (line["directions"], line["read"]) == (count, read)]
        cells = [text for o in own for text in (f"{o['misjudged']:.2%}", f"{o['grazing']:.1%}", f"{o['rms']:.3f}")]
        rows.append([str(count), read, *cells])
    return rows


def _rows(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = ["| " + " | ".join(heads) + " |", "| --- " + "| ---: " * (len(heads) - 1) + "|"]
    return "\n".join([*lines, *("| " + " | ".join(row) + " |" for row in rows)])
