"""What interpolated key frames err by, and what they save: Dufort 2005, section 5.3.3, as a page.

A motion by few poses is sampled at more and more key frames a round; planes and maps interpolated between them are held
to those computed at the same moments, on the cells themselves and in pictures.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure

from renderer.core.baking import gather
from renderer.shells.animation import MovingShell, Posed, motion_of
from renderer.shells.animation_frames import frame_error
from renderer.shells.bakes import shell_bake, surface_bake
from renderer.shells.course import Key, key_at
from renderer.shells.shell import Shell
from renderer.shells.state import ShellsState
from renderer.study.charts import COLOURS, MARKERS, save
from renderer.study.sweep import provenance

if TYPE_CHECKING:
    from renderer.session import Session

COUNTS = (4, 8, 16, 32, 64)
"""Key frames a round."""

MOMENTS = 24
"""Times of a round at which errors are taken."""

SHOWN = 3
"""Of these, how many are drawn."""

PRESET = "tube_keys"
"""Whose poses are sampled."""

SURFACES: Mapping[str, Mapping[str, Any]] = {
    "tube": {"kind": "tube", "along": 12},
    "teapot": {"kind": "teapot"},
}

FILES = ("table.md", "results.json", "keys.png", "keys.svg")
"""What the documentation keeps."""

ASTRAY = 0.05
"""Error of u, v or w that is seen: a twentieth of a repeat, or of the shell's thickness."""

GOLDEN = (3 - 5**0.5) / 2

TIMED_S = 0.4
"""Processor time that each side is given at least."""

Tell = Callable[[float, str], None]


def sampled(state: ShellsState, count: int, planes: str) -> ShellsState:
    """A state whose key frames are the poses of its own at even times of a round."""
    course = state.course
    times = [course.period * number / count for number in range(count)]
    keys = tuple(Key(**{**key_at(course, at).model_dump(), "at": at}) for at in times)
    motion = state.motion.model_copy(update={"planes": planes})
    return state.model_copy(update={"course": course.model_copy(update={"keys": keys}), "motion": motion})


def errors(state: ShellsState, arrays: Mapping[str, Mapping[str, np.ndarray]], count: int) -> dict[str, Any]:
    """What key frames err by against the shell computed at the same moments, root mean squares over a round.

    Returns:
        `texture`, of u, v and w, weighted with the cells' volumes; `astray`, the share of the volume whose maps err by
        more than `ASTRAY`; `plane` and `place` [m]; `mebibytes`; `microseconds` of processor time a moment,
        interpolated and computed.
    """
    kept, shape = sampled(state, count, "interpolated"), (arrays["surface"], arrays["shell"], state.extrusion)
    motion, exact = (motion_of(one.motion, one.course) for one in (kept, state))
    assert isinstance(motion, Posed)
    assert isinstance(exact, Posed)
    between, computed = MovingShell(*shape), MovingShell(*shape)
    squares = np.zeros(4)  # and a share, whose root is taken back
    for moment in _moments(state.course.period):
        between.interpolate(motion, moment)
        computed.move(replace(exact, planes="computed"), moment)
        error = frame_error(between.shell, computed.shell)
        maps, astray = map_error(between.shell, computed.shell)
        squares += np.array([maps, astray, error.plane**2, error.place**2])
    texture, astray, plane, place = np.sqrt(squares / MOMENTS)
    shell = between.shell
    size = count * (shell.positions.nbytes + shell.planes.nbytes + shell.to_texture.nbytes)
    return {
        "keys": count, "texture": texture, "astray": astray**2, "plane": plane, "place": place,
        "mebibytes": size / 2**20, "microseconds": _timed(between, motion, computed, exact),
    }  # fmt: skip


def map_error(between: Shell, exact: Shell) -> tuple[float, float]:
    """Mean square of the error of u, v and w at cells' corners, and the share of cells that are off by more than
    `ASTRAY`, each cell with the weight of its volume: the maps of slivers, where next to nothing is seen, err without
    bounds."""
    corners = between.positions[between.tets]
    mapped = np.einsum("nab,nkb->nka", between.to_texture[..., :3], corners) + between.to_texture[:, None, :, 3]
    weight = np.abs(exact.volumes) / np.abs(exact.volumes).sum()
    error = mapped - between.texture
    off = np.abs(error).max(axis=(1, 2)) > ASTRAY
    return float(weight @ (error**2).sum(axis=2).mean(axis=1)), float(weight[off].sum())


def _moments(period: float) -> list[float]:
    """Times over a round that lie anywhere between key frames, however many there are: steps of the golden section."""
    return [period * ((0.2 + number * GOLDEN) % 1.0) for number in range(MOMENTS)]


def _timed(between: MovingShell, motion: Posed, computed: MovingShell, exact: Posed) -> list[float]:
    """Processor time of a moment, interpolated and computed [us], the two in turn."""
    spent, done = np.zeros(2), 0
    still = replace(exact, planes="computed")
    while spent.min() < TIMED_S:
        moment = exact.period * (done * GOLDEN % 1.0)
        start = time.process_time()
        between.interpolate(motion, moment)
        middle = time.process_time()
        computed.move(still, moment)
        spent += (middle - start, time.process_time() - middle)
        done += 1
    return [float(value) for value in spent / done * 1e6]


def measure(session: Session, size: int, tell: Tell | None = None) -> dict[str, Any]:
    """Sample the motion more and more finely on each surface.

    Args:
        size: side of the pictures [px]. tell: told the share done.

    Returns:
        `lines`, one a surface and count: the fields of `errors` and `picture`, relative RMSE of pictures; `cells` of
        each surface; `machine`, `size`.
    """
    lines, cells = [], {}
    for place, (name, surface) in enumerate(SURFACES.items()):
        state = _state(session, surface)
        arrays = dict(gather([surface_bake(state), shell_bake(state)], session.cache))
        cells[name] = len(arrays["shell"]["tets"])
        for number, count in enumerate(COUNTS):
            if tell is not None:
                tell((place + number / len(COUNTS)) / len(SURFACES), f"{name}, {count} key frames")
            found = errors(state, arrays, count)
            lines.append({"surface": name, **found, "picture": _pictures(session, state, count, size)})
    return {"lines": lines, "cells": cells, "machine": provenance(session.gl.info.renderer), "size": size}


def _state(session: Session, surface: Mapping[str, Any]) -> ShellsState:
    """The preset on another surface, its planes computed."""
    motion = {"kind": "keys", "planes": "computed"}
    sets = {"surface": surface, "motion": motion, "quality": {"kind": "samples", "n": 4}}
    found = session.state("shells", PRESET, sets)
    assert isinstance(found, ShellsState)
    return found


def _pictures(session: Session, state: ShellsState, count: int, size: int) -> float:
    """Relative RMSE of pictures with interpolated planes against those with computed ones."""
    moments = _moments(state.course.period)[1 :: MOMENTS // SHOWN][:SHOWN]
    squares = []
    for moment in moments:
        pair = [
            session.render(one.model_copy(update={"time": moment}), size, size).linear
            for one in (sampled(state, count, "interpolated"), state)
        ]
        squares.append(np.mean((pair[0] - pair[1]) ** 2) / np.mean(pair[1] ** 2))
    return float(np.sqrt(np.mean(squares)))


def table(found: Mapping[str, Any]) -> str:
    """The page's text."""
    machine = found["machine"]
    text = (
        f"Key frames of a shell whose planes and maps are computed once and interpolated: {machine['renderer']}, "
        f"{machine['cores']} cores\n\nThe poses of the preset `{PRESET}` sampled at even times of a round of 8 s; root "
        f"mean squares over {MOMENTS} moments, against the shell computed at each. Of u, v and w: what the maps give "
        "at the cells' corners against what belongs there, by the cells' volumes; and the share of the volume "
        f"where one of them is off by more than {ASTRAY:g}. Planes: distance of the corners from "
        "the planes that should hold them. Vertices: from where the motion has them. Pictures: relative RMSE of "
        f"{SHOWN} moments, {found['size']} px a side, 4 samples a pixel. Times are of the processor, for a moment.\n"
    )
    head = ["key frames", "u, v, w", "astray, %", "planes, mm", "vertices, mm", "pictures, %", "MiB", "us"]
    head.append("us computed")
    for name, cells in found["cells"].items():
        rows = [head, ["---:"] * len(head)]
        for line in (line for line in found["lines"] if line["surface"] == name):
            interpolated, computed = line["microseconds"]
            shares = (line["texture"], 100 * line["astray"], 1e3 * line["plane"], 1e3 * line["place"],
                      100 * line["picture"], line["mebibytes"])  # fmt: skip
            times = (f"{interpolated:.0f}", f"{computed:.0f}")
            rows.append([str(line["keys"]), *(f"{value:.3g}" for value in shares), *times])
        text += f"\n`{name}`, {cells:,} tetrahedra\n\n" + "".join("| " + " | ".join(row) + " |\n" for row in rows)
    return text


def chart(found: Mapping[str, Any]) -> Figure:
    """Errors against the number of key frames."""
    figure = Figure(figsize=(7.5, 4.2), layout="constrained")
    axes = figure.subplots()
    kinds = (("astray", "maps: share of the volume astray"), ("plane", "planes, m"), ("picture", "pictures, relative"))
    for place, name in enumerate(found["cells"]):
        own = [line for line in found["lines"] if line["surface"] == name]
        for number, (key, words) in enumerate(kinds):
            axes.plot([line["keys"] for line in own], [line[key] for line in own], color=COLOURS[number],
                      marker=MARKERS[place], linestyle=("-", "--")[place], label=f"{words}: {name}")  # fmt: skip
    axes.set(xscale="log", yscale="log", xlabel="key frames a round", ylabel="root mean square error")
    axes.set_xticks(COUNTS, [str(count) for count in COUNTS])
    axes.minorticks_off()
    axes.legend(fontsize="small")
    axes.grid(alpha=0.3)
    return figure


def write(found: Mapping[str, Any], folder: Path) -> str:
    """Write `FILES`, and return the page's text."""
    folder.mkdir(parents=True, exist_ok=True)
    text = table(found)
    (folder / "table.md").write_text(text, encoding="utf-8")
    (folder / "results.json").write_text(json.dumps(found, indent=1), encoding="utf-8")
    save(chart(found), folder, "keys")
    return text
