"""Tables and charts of `renderer.radiosity_study`, and the folder that holds them with the raw results."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from renderer import radiosity_charts as charts
from renderer import radiosity_ridges
from renderer import radiosity_study as study
from renderer.clouds.radiosity import numbers
from renderer.core.cache import Cache
from renderer.core.failure import ChartedFailure
from renderer.failing import charted, document
from renderer.radiosity_failures import CASES

Lines = list[dict[str, Any]]
CHARTS = (*(f"profiles_{scene}" for scene in charts.SCENES), "errors", "cut", "ridges", "slopes")
FILES = ("table.md", "results.jsonl", "errors.svg", *(f"{name}.png" for name in CHARTS))
"""What the documentation keeps."""


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
    for case in study.cases(rays, Cache(), lambda share, words: tell(0.7 * share, words)):
        lines, fields = study.scene_lines(case)
        parts["scenes"] += lines
        _save(folder, f"profiles_{case.scene.name}", charts.profiles(case.scene.title, fields))
    parts["ridges"] = radiosity_ridges.ridge_lines(
        max(rays // 8, 64), lambda share, words: tell(0.7 + 0.2 * share, words)
    )
    tell(0.9, "numbers of the thesis, failures")
    parts["numbers"] = [number.document() for number in numbers.numbers()]
    parts["failures"] = [_failure(case) for case in CASES]
    parts["solving"] = [study.solving_time(squares, count) for squares, count in ((256, 15), (256, 64), (16, 256))]
    with (folder / "results.jsonl").open("w", encoding="utf-8") as file:
        for name, lines in parts.items():
            file.writelines(json.dumps({"part": name, "rays": rays, **line}) + "\n" for line in lines)
    for name, figure in (
        ("errors", charts.errors_chart(parts["scenes"])),
        ("cut", charts.cut_chart()),
        ("slopes", charts.slopes_chart()),
        ("ridges", charts.ridges_chart(parts["ridges"])),
    ):
        _save(folder, name, figure)
    text = table(parts, rays)
    (folder / "table.md").write_text(text, encoding="utf-8")
    return text


def _failure(case: ChartedFailure) -> dict[str, Any]:
    now = charted(case)
    return document(case, {"failing_now": now.failing, "surviving_now": now.surviving})


def _save(folder: Path, name: str, figure: Figure) -> None:
    FigureCanvasAgg(figure)
    # Without a date, the same results give the same file.
    figure.savefig(folder / f"{name}.png", dpi=100, metadata={"Software": None})
    figure.savefig(folder / f"{name}.svg", metadata={"Date": None})


def table(parts: Mapping[str, Lines], rays: int) -> str:
    """All of it as Markdown."""
    sections = [
        f"Light between ground and clouds (`umbrage study clouds --radiosity`). Truth: rays ({rays:,} a point) over "
        "relief, quadrature over level ground. Compute square of side 32H, H = 2,500 m; relative RMSE of the radiosity "
        "over the render square of side 16H: against the truth averaged over the basis' cells, place by place, the "
        "basis' own floor (the truth projected on it), and in means over 2H, to which every technique can be held. "
        "Gathered is what is drawn: each place gathers what the basis found by the kernel of level planes. "
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
