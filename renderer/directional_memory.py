"""How large the tables of the directional textures become, and how long their precomputation takes.

Bytes, seconds of all processors together and the time to unpack one layer, against texels, directions and subject; and
two whole bakes, the coarse one and the default, timed by the clock too.
"""

from __future__ import annotations

import json
import os
import platform
import resource
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from renderer import directional_code_study as code_study
from renderer.core.technique import Arrays, Bake
from renderer.directional.casting import NONE, Caster, face_frame, face_middles
from renderer.directional.cloud import Cloud, bake_cloud, cloud_bake, rounded_positions
from renderer.directional.hemisphere import hemisphere_of
from renderer.directional.index_code import packed, unpacked
from renderer.directional.subjects import bake_subject
from renderer.directional.visibility import FACES, Visibility, layer, visibility_bake
from renderer.study.charts import COLOURS, MARKERS

FILES = ("table.md", "memory.png", "results.jsonl")
"""What the documentation keeps."""

SUBJECTS = ("dragon", "tree", "relief")
TEXELS = (64, 128, 256)
DIRECTIONS = (129, 513, 2049)
BITS = (8, 10, 12, 16)

RAYS = 3_000_000
"""Cast for each line of the table: a share of its directions, evenly among all faces and rows."""

RAW = 3
"""Bytes of a number as Porquet 2005 stores it."""

WHOLE = ((64, 129, 100_000), (128, 513, 1_500_000))
"""Texels, directions and points of the coarse bake and of the default."""

Tell = Callable[[float, str], None]


def run(folder: Path, tell: Tell) -> str:
    """Measure everything and leave raw results, table and chart in a folder.

    Args:
        folder: made where it is missing.
        tell: told the share done; may raise `Cancelled`.

    Returns:
        The table.
    """
    lines: list[dict[str, Any]] = [{"part": "machine", "processor": _processor(), "cores": os.cpu_count(),
                                    "load": os.getloadavg()[0]}]
    for place, kind in enumerate(SUBJECTS):
        tell(0.8 * place / len(SUBJECTS), f"tables of the {kind}")
        lines += tables(kind)
    for place, (texels, directions, points) in enumerate(WHOLE):
        tell(0.8 + 0.1 * place, f"a whole bake of {points:,} points")
        lines.append(whole(SUBJECTS[0], texels, directions, points))
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "results.jsonl").open("w", encoding="utf-8") as file:
        file.writelines(json.dumps(line) + "\n" for line in lines)
    text = table(lines)
    (folder / "table.md").write_text(text, encoding="utf-8")
    figure = chart([line for line in lines if line["part"] == "table"])
    FigureCanvasAgg(figure)
    figure.savefig(folder / "memory.png", dpi=90, metadata={"Software": None})
    return text


def tables(kind: str, points: int = WHOLE[-1][2], rays: int = RAYS) -> list[dict[str, Any]]:
    """Lines of one subject: `table` for each number of texels and directions, `codes`, and `positions` by bits."""
    subject = bake_subject({"kind": kind}, {}, _silent)
    cloud = bake_cloud({"points": points}, {"subject": subject}, _silent)
    caster = Caster(subject, cloud)
    lines = []
    for texels in TEXELS:
        for directions in DIRECTIONS:
            lines.append({"part": "table", "subject": kind, "texels": texels, "directions": directions,
                          **sampled(caster, texels, directions, rays)})
    lines += code_study.codes(kind, caster, cloud)
    extent = caster.box[1] - caster.box[0]
    for bits in BITS:
        off = rounded_positions(cloud["position"].astype(float), caster.box, bits) - cloud["position"]
        rms = float(np.sqrt((off**2).sum(axis=1).mean()))
        lines.append({"part": "positions", "subject": kind, "bits": bits, "rms_m": rms,
                      "rms_texels": rms / float(extent.max() / 128), "rms_spacings": rms / float(cloud["spacing"])})
    return lines


def sampled(caster: Caster, texels: int, directions: int, rays: int) -> dict[str, float]:
    """Bytes and times of all layers, from some of them.

    Returns:
        `share` of the layers that were looked at; `bits` a texel; `bytes` of all layers; `raw_ratio` of three bytes a
        texel to these; `cpu_s` to cast and pack all; `unpack_ms` a layer; `seen` share of texels that see a point.
    """
    every = FACES * directions
    count = int(np.clip(rays // texels**2, FACES, every))
    chosen = np.unique(np.linspace(0, every - 1, count).astype(int))
    origins = [face_middles(caster.box, face, texels) for face in range(FACES)]
    ways = hemisphere_of(directions).directions()
    started = time.process_time()
    kept, seen = [], 0
    for number in chosen:
        face = int(number) // directions
        points = caster.points(origins[face], -(ways[number % directions] @ face_frame(face)))
        seen += int((points != NONE).sum())
        kept.append(packed(points))
    spent = time.process_time() - started
    started = time.process_time()
    for data in kept:
        unpacked(data, texels**2)
    unpacking = time.process_time() - started
    size = sum(map(len, kept)) / len(chosen)
    return {
        "share": len(chosen) / every, "bits": 8 * size / texels**2, "bytes": size * every,
        "raw_ratio": RAW * texels**2 / size, "cpu_s": spent / len(chosen) * every,
        "unpack_ms": 1e3 * unpacking / len(chosen), "seen": seen / len(chosen) / texels**2,
    }


def whole(kind: str, texels: int, directions: int, points: int) -> dict[str, Any]:
    """A bake from subject to tables, nothing kept: seconds by the clock and of all processors, the largest memory of
    the process so far, the bytes of the tables and the share of points in use."""
    subject = Bake("subject", bake_subject, {"kind": kind})
    bake = visibility_bake(Visibility(texels=texels, directions=directions),
                           subject, cloud_bake(Cloud(points=points), subject))
    spent: dict[str, float] = {}
    clock = time.monotonic()
    arrays = _computed(bake, spent, {})
    clock = time.monotonic() - clock
    number = len(arrays["number"])
    started = time.process_time()
    for direction in range(0, directions, 8):
        layer(arrays, 5, direction)
    reading = (time.process_time() - started) / len(range(0, directions, 8))
    return {
        "part": "whole", "subject": kind, "texels": texels, "directions": directions, "points": number,
        "clock_s": clock, "cpu_s": sum(spent.values()), **{f"{name}_cpu_s": value for name, value in spent.items()},
        "bytes": sum(arrays[f"data_{face}"].nbytes for face in range(FACES)), "used": len(arrays["used"]) / number,
        "layer_ms": 1e3 * reading, "most_memory_bytes": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024,
    }


def _computed(bake: Bake, spent: dict[str, float], made: dict[str, Arrays]) -> Arrays:
    """The bake's arrays, inputs first, each once; seconds of all processors by what was made."""
    for source in bake.inputs:
        if source.name not in made:
            made[source.name] = _computed(source, spent, made)
    started = time.process_time()
    arrays = bake.function(bake.arguments, {source.name: made[source.name] for source in bake.inputs}, _silent)
    name = bake.name.split("_")[0]
    spent[name] = spent.get(name, 0.0) + time.process_time() - started
    return arrays


def _silent(share: float, words: str) -> None:
    pass


def _processor() -> str:
    try:
        named = [line for line in Path("/proc/cpuinfo").read_text().splitlines() if line.startswith("model name")]
    except OSError:
        named = []
    return named[0].split(":", 1)[1].strip() if named else platform.processor() or platform.machine()


def table(lines: list[dict[str, Any]]) -> str:
    """The table in words."""
    machine = lines[0]
    text = [
        "# Memory and precomputation of the directional textures", "",
        f"{machine['processor']}, {machine['cores']} cores, {machine['load']:.1f} processes wanting them when it "
        "began: seconds are those of all processors together, which others' work disturbs little; the clock's are "
        f"said where they are meant. {WHOLE[-1][2]:,} points. A line is measured on a share of its layers, evenly "
        "among faces and rows, and taken to the whole. Three bytes a number are what Porquet 2005 stores.", "",
        "| subject | texels | directions | measured | table | bits a texel | of three bytes | cast and pack | unpack "
        "one layer | texels that see |", "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    for line in _of(lines, "table"):
        text.append(
            f"| {line['subject']} | {line['texels']} | {line['directions']:,} | {line['share']:.1%} | "
            f"{line['bytes'] / 1e6:,.1f} MB | {line['bits']:.2f} | 1 / {line['raw_ratio']:.1f} | "
            f"{line['cpu_s']:,.1f} s | {line['unpack_ms']:.2f} ms | {line['seen']:.0%} |"
        )
    text += ["", "Whole bakes, from nothing, in one process:", "",
             "| subject | texels | directions | points | clock | processors | subject | points | faces | table | "
             "points in use | one layer | most memory |", "| --- |" + " ---: |" * 12]
    for line in _of(lines, "whole"):
        text.append(
            f"| {line['subject']} | {line['texels']} | {line['directions']:,} | {line['points']:,} | "
            f"{line['clock_s']:.1f} s | {line['cpu_s']:.1f} s | {line['subject_cpu_s']:.1f} s | "
            f"{line['cloud_cpu_s']:.1f} s | {line['faces_cpu_s']:.1f} s | {line['bytes'] / 1e6:.1f} MB | "
            f"{line['used']:.0%} | {line['layer_ms']:.2f} ms | {line['most_memory_bytes'] / 1e6:,.0f} MB |"
        )
    text += ["", "Other ways to write the same numbers, on some directions of three faces:", ""]
    text += code_study.table(_of(lines, "codes"))
    text += ["", "Error of stored positions, root of the mean square:", "",
             "| subject | bits a coordinate | error | of a texel at 128 | of the distance between points |",
             "| --- | ---: | ---: | ---: | ---: |"]
    for line in _of(lines, "positions"):
        text.append(f"| {line['subject']} | {line['bits']} | {line['rms_m'] * 1e3:.3f} mm | {line['rms_texels']:.3f} | "
                    f"{line['rms_spacings']:.3f} |")
    return "\n".join(text) + "\n"


def _of(lines: list[dict[str, Any]], part: str) -> list[dict[str, Any]]:
    return [line for line in lines if line["part"] == part]


def chart(lines: list[dict[str, Any]]) -> Figure:
    """Bytes and seconds against directions, a line for each number of texels, a panel for each subject."""
    figure = Figure(figsize=(10.5, 6.4), layout="constrained")
    panels = figure.subplots(2, len(SUBJECTS), sharex=True, sharey="row", squeeze=False)
    for column, kind in enumerate(SUBJECTS):
        for colour, marker, texels in zip(COLOURS, MARKERS, TEXELS):
            own = [line for line in lines if line["subject"] == kind and line["texels"] == texels]
            across = [line["directions"] for line in own]
            raw = [FACES * texels**2 * directions * RAW / 1e6 for directions in across]
            panels[0, column].loglog(across, [line["bytes"] / 1e6 for line in own], color=colour, marker=marker,
                                     label=f"{texels} texels")
            panels[0, column].loglog(across, raw, color=colour, linestyle=":", label=f"{texels}, three bytes each")
            panels[1, column].loglog(across, [line["cpu_s"] for line in own], color=colour, marker=marker)
        panels[0, column].set_title(kind)
        panels[1, column].set_xlabel("directions")
        panels[1, column].set_xticks(DIRECTIONS, [f"{value:,}" for value in DIRECTIONS])
        panels[1, column].minorticks_off()
        for row in (0, 1):
            panels[row, column].grid(alpha=0.3)
    panels[0, 0].set_ylabel("table, MB")
    panels[1, 0].set_ylabel("cast and pack, s of one processor")
    panels[0, 0].legend(fontsize=7)
    return figure
