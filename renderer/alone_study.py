"""Every technique of a scene alone, everything else at its default: table, chart and the page's facts.

For scenes whose slots have little to do with each other, so that not every combination must be drawn.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from renderer import technique_facts
from renderer.core.baking import bake_key, bake_now
from renderer.core.registry import phenomenon, techniques
from renderer.study.charts import COLOURS, MARKERS, pareto, plain_axes
from renderer.study.sweep import append, provenance, read

if TYPE_CHECKING:
    from renderer.session import Session

Tell = Callable[[float, str], None]
Lines = Sequence[Mapping[str, Any]]

FILES = ("table.md", "speed_accuracy.svg", "speed_accuracy.png")

NAN = float("nan")


def run(
    session: Session,
    scene: str,
    folder: Path,
    size: int,
    frames: int,
    tell: Tell | None = None,
    presets: Sequence[str] = (),
) -> None:
    """Measure, and write `results.jsonl`, `facts.json` and `FILES`.

    Args:
        session: draws, bakes and caches.
        scene: its name.
        folder: of the files; results in it are not measured again.
        size: side of the pictures that are judged, pixels. frames: timed frames of each technique.
        tell: told the share done. presets: all without a group where none is named.
    """
    folder.mkdir(parents=True, exist_ok=True)
    errors, times, unit = technique_facts.measured(session, scene, folder, size, frames, tell, presets)
    baked = bakes(session, scene, folder / "results.jsonl", tell)
    technique_facts.keep(folder, technique_facts.facts(scene, errors, times, size, unit))
    rows = rows_of(scene, errors, times, baked, unit)
    machine = errors[0]["machine"]
    title = f"{scene}: each technique alone, {size} px, {machine['renderer']}, {machine['cores']} cores"
    noise = float(np.median([line["reference_standard_error"] for line in errors]))
    (folder / "table.md").write_text(
        f"{title}\n\n{_note(errors, noise, unit, frames)}\n\n{table(rows)}\n"
        f"{by_preset(scene, errors)}", encoding="utf-8"
    )
    figure = chart(rows, title)
    FigureCanvasAgg(figure)
    figure.savefig(folder / "speed_accuracy.png", dpi=100, metadata={"Software": None})
    figure.savefig(folder / "speed_accuracy.svg", metadata={"Date": None})


def bakes(session: Session, scene: str, results: Path, tell: Tell | None = None) -> dict[str, dict[str, float]]:
    """What each technique bakes for itself: `bytes`, and processor `seconds`, by `slot.kind`."""
    known = {line["key"]: line for line in read(results) if line["kind"] == "bake"}
    found: dict[str, dict[str, float]] = {}
    machine = provenance(session.gl.info.renderer)
    for slot in phenomenon(scene).slots:
        for kind in techniques(scene, slot.name):
            state: Any = session.state(scene, None, {f"{slot.name}.kind": kind})
            total = {"bytes": 0.0, "seconds": 0.0}
            for bake in getattr(state, slot.name).bakes(state):
                key = bake_key(bake)
                if key not in known:
                    if tell is not None:
                        tell(0.99, f"what {kind} bakes")
                    inputs = {source.name: bake_now(source, session.cache) for source in bake.inputs}
                    begun = time.process_time()
                    arrays = bake.function(bake.arguments, inputs, lambda share, words: None)
                    known[key] = {"kind": "bake", "key": key, "name": bake.name,
                                  "bytes": sum(array.nbytes for array in arrays.values()),
                                  "seconds": time.process_time() - begun, "machine": machine,
                                  "when": int(time.time())}  # fmt: skip
                    append(results, known[key])
                total = {name: value + known[key][name] for name, value in total.items()}
            found[f"{slot.name}.{kind}"] = total
    return found


def rows_of(
    scene: str, errors: Lines, times: Lines, baked: Mapping[str, Mapping[str, float]], unit: float
) -> list[dict[str, Any]]:
    """One row a technique: `slot`, `kind`, whether it is the `default`, and its numbers."""
    slots = phenomenon(scene).slots
    default = {slot.name: slot.default for slot in slots}
    found = []
    for slot in slots:
        for kind in techniques(scene, slot.name):
            chosen = {**default, slot.name: kind}
            own = [line for line in errors if line["techniques"] == chosen and "failed" not in line]
            took = {line["parameters"]["moves"]: line["yardsticks"] for line in times
                    if line["techniques"] == chosen and "failed" not in line}  # fmt: skip
            found.append({
                "slot": slot.name, "kind": kind, "default": kind == slot.default,
                **{name: _of(own, key, how) for name, (key, how) in MEASURES.items()},
                "sun": took.get("sun", NAN), "camera": took.get("camera", NAN),
                "ms": took.get("sun", NAN) * unit, **baked.get(f"{slot.name}.{kind}", {"bytes": NAN, "seconds": NAN}),
            })  # fmt: skip
    return found


MEASURES: Mapping[str, tuple[str, Callable[[Any], Any]]] = {
    "error": ("relative_rmse", np.median),
    "worst": ("relative_rmse", np.max),
    "own": ("relative_rmse_without_noise", np.median),
    "gained": ("relative_rmse_after_gain", np.median),
    "flip": ("flip_mean", np.median),
}


def _of(lines: Lines, key: str, how: Callable[[Any], Any]) -> float:
    values = [line[key] for line in lines if line.get(key) is not None]
    return float(how(values)) if values else NAN


COLUMNS = (
    ("median relative RMSE", "error"), ("worst", "worst"), ("without the reference's noise", "own"),
    ("after one gain", "gained"), ("median FLIP", "flip"), ("frame, sun moving, ms", "ms"),
    ("yardsticks", "sun"), ("camera moving", "camera"), ("baked, bytes", "bytes"), ("bake, processor s", "seconds"),
)  # fmt: skip


def table(rows: Sequence[Mapping[str, Any]]) -> str:
    """The rows as a Markdown table, the defaults in bold."""
    lines = [["slot", "technique", *(heading for heading, _ in COLUMNS)], ["---"] * 2 + ["---:"] * len(COLUMNS)]
    for row in rows:
        name = f"**{row['kind']}**" if row["default"] else row["kind"]
        lines.append([row["slot"], name, *(_cell(row[key]) for _, key in COLUMNS)])
    return "".join("| " + " | ".join(line) + " |\n" for line in lines)


def by_preset(scene: str, errors: Lines) -> str:
    """Relative RMSE of each technique in each view, and the reference's own error, as a Markdown table."""
    presets = list(dict.fromkeys(line["preset"] for line in errors))
    slots = phenomenon(scene).slots
    default = {slot.name: slot.default for slot in slots}
    lines = [["relative RMSE", *presets], ["---"] + ["---:"] * len(presets)]
    chosen = [("default", default)] + [
        (f"{slot.name}: {kind}", {**default, slot.name: kind})
        for slot in slots for kind in techniques(scene, slot.name) if kind != slot.default
    ]  # fmt: skip
    for label, one in chosen:
        known = {line["preset"]: line.get("relative_rmse", NAN) for line in errors if line["techniques"] == one}
        lines.append([label, *(_cell(known.get(preset, NAN)) for preset in presets)])
    noise = {line["preset"]: line.get("reference_standard_error", NAN) for line in errors}
    lines.append(["reference's standard error", *(_cell(noise[preset]) for preset in presets)])
    return "".join("| " + " | ".join(line) + " |\n" for line in lines)


def chart(rows: Sequence[Mapping[str, Any]], title: str) -> Figure:
    """Frame time against error, one colour a slot, one marker a technique of it, the Pareto front drawn."""
    figure = Figure(figsize=(8.5, 5.5), layout="constrained")
    axes = figure.add_subplot(
        xscale="log", yscale="log", title=title, xlabel="one frame, the sun moving, ms", ylabel="median relative RMSE"
    )
    shown = [row for row in rows if np.isfinite(row["ms"]) and np.isfinite(row["error"])]
    slots = list(dict.fromkeys(row["slot"] for row in shown))
    seen: dict[str, int] = {}
    for row in shown:
        number = seen[row["slot"]] = seen.get(row["slot"], -1) + 1
        colour = COLOURS[slots.index(row["slot"]) % len(COLOURS)]
        label = f"{row['slot']}: {row['kind']}" + (" (default)" if row["default"] else "")
        axes.plot(row["ms"], row["error"], MARKERS[number % len(MARKERS)], color=colour, markersize=8,
                  markeredgecolor="white", linestyle="none", label=label)  # fmt: skip
    costs, wrong = [row["ms"] for row in shown], [row["error"] for row in shown]
    front = sorted(pair for pair, on in zip(zip(costs, wrong, strict=True), pareto(costs, wrong), strict=True) if on)
    axes.step([f[0] for f in front], [f[1] for f in front], where="post", color="black", linewidth=1, label="front")
    plain_axes(axes)
    axes.legend(fontsize="x-small", loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def _cell(value: float) -> str:
    return f"{value:.3g}" if np.isfinite(value) else "-"


def _note(errors: Lines, noise: float, unit: float, frames: int) -> str:
    presets = ", ".join(dict.fromkeys(line["preset"] for line in errors))
    return (
        f"Everything else at its default (bold), in the presets {presets} under their own suns. A frame is 512 x 512, "
        f"median of {frames} in turns; the quickest yardstick took {unit:.0f} ms. The reference's standard error is "
        f"{noise:.2g} of the mean."
    )
