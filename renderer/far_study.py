"""Shells from near and from far: whether what is filtered stays as bright and as opaque as what is not.

Each technique of the slot `filter` is drawn with all else as exact as pictures have it, so that it answers alone; the
default picture is drawn beside them, with all that it spares.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from renderer.choices import Choice, choices_of
from renderer.comparing import truth
from renderer.core.channel import Progress
from renderer.core.errors import InputError
from renderer.steadying import CAMERA_STEP, PARAMETER_STEP, Plan
from renderer.study.charts import COLOURS
from renderer.world.camera import Orbit
from renderer.world.state import SceneState

if TYPE_CHECKING:
    from renderer.session import Session

TIMES = (2, 4, 8, 12, 16)
"""How many times as far as its own camera stands a preset is seen from."""

PRESETS = ("fur", "teapot_relief", "teapot_wicker")

LINES = 512
"""Side of the picture whose pixels are drawn; from farther off its middle is, which holds the same."""

JUDGED = 32
"""Side of the references, pixels of 16 positions."""

RAYS = 1 << 14
"""Of a picture: the fewer pixels it has, the more samples each."""

EXACT: Mapping[str, Any] = {
    "sampling": {"kind": "adaptive", "rate": 2.0, "lit": 0.0, "most": 64},
    "shadow": {"kind": "sun_walk"},
}
"""What is drawn beside the filter: light at every sample, and of every sample its own way to the sun."""

BARE: Mapping[str, Any] = {"base.opaque": False, "light": {"kind": "unlit"}, "shadow": {"kind": "none"}}
"""The shell without its surface: what it hides is the matter's alone."""

TECHNIQUES = "none,mipmap,mipmap:bias=-1,directional,directional:bias=-1"
DEFAULT, FIRST = "default picture", "its first sample"
SETTLED = 64
"""Samples a pixel of the default picture, at least: it moves what it samples from one to the next, and has converged
when it has been everywhere."""

FILES = ("results.json", "table.md", "distance.png", "distance.svg")

Tell = Callable[[float, str], None]


@dataclass(frozen=True)
class Line:
    """A technique from one distance.

    Attributes:
        preset, label: whose, and which. times: the preset's own distance. pixel: width of one in the middle [m].
        brightness, opacity: mean over the picture against the reference's, 1 where they agree.
        error: of the reference's mean brightness, relative, at most.
    """

    preset: str
    label: str
    times: float
    pixel: float
    brightness: float
    opacity: float
    error: float


def seen(session: Session, preset: str, times: float, sets: Mapping[str, Any]) -> SceneState:
    """A preset from so many times as far, in a picture that holds as much of it.

    Raises:
        InputError: its camera orbits nothing.
    """
    state = session.state("shells", preset, dict(sets))
    camera: Any = state.camera
    if not isinstance(camera, Orbit):
        raise InputError("presets", f"{preset} has a camera that stays where it is", "a preset with an orbit")
    half = math.tan(math.radians(camera.field_of_view) / 2) / times
    far = {"distance": camera.distance * times, "field_of_view": 2 * math.degrees(math.atan(half))}
    return state.model_copy(update={"camera": camera.model_copy(update=far)})


def variants(techniques: str) -> list[tuple[str, dict[str, Any], dict[str, Any]]]:
    """Label of each picture, and what it sets where it is lit and where it is bare."""
    found: list[tuple[str, dict[str, Any], dict[str, Any]]] = []
    for choice in choices_of("shells", "filter", techniques):
        own = {"filter": {"kind": choice.kind, **choice.parameters}}
        found.append((choice.label, {**EXACT, **own}, {**EXACT, **BARE, **own}))
    return [*found, (DEFAULT, {}, dict(BARE)), (FIRST, {}, dict(BARE))]


def measure(
    session: Session, presets: Sequence[str], techniques: str, times: Sequence[float], tell: Tell
) -> list[Line]:
    """Means of every preset from every distance by every technique; blocks.

    Raises:
        InputError: a technique or a preset that there is not, or a picture of nothing.
    """
    lines, kinds, count = [], variants(techniques), len(presets) * len(times)
    for number, (preset, far) in enumerate([(one, far) for one in presets for far in times]):
        means, error = [], 0.0
        for part, sets in enumerate(({}, BARE)):

            def inner(progress: Progress, at: float = number + 0.25 * part, name: str = preset) -> None:
                tell((at + 0.25 * progress.fraction) / count, f"{name}: {progress.words}")

            exact = truth(session, seen(session, preset, far, sets), JUDGED, JUDGED, "combination", inner)
            means.append(_means(exact.linear))
            error = error or exact.standard_error / JUDGED
        if min(means[0][0], means[1][1]) <= 0:
            raise InputError("presets", f"{preset} shows nothing but background")
        for turn, (label, lit, bare) in enumerate(kinds):
            tell((number + 0.5 + 0.5 * turn / len(kinds)) / count, f"{preset}, {far:g} times as far: {label}")
            brightness = _drawn(session, seen(session, preset, far, lit), far, label)[0] / means[0][0]
            opacity = _drawn(session, seen(session, preset, far, bare), far, label)[1] / means[1][1]
            lines.append(Line(preset, label, far, _pixel(session, preset, far), brightness, opacity, error))
    return lines


def _drawn(session: Session, state: SceneState, times: float, label: str) -> tuple[float, float]:
    side = max(8, round(LINES / times))
    samples = 1 if label == FIRST else max(SETTLED if label == DEFAULT else 1, RAYS // side**2)
    plain = state.model_copy(update={"view": state.view.model_copy(update={"background": "none"})})
    return _means(session.draw(plain, side, side, samples).linear)


def _means(linear: np.ndarray) -> tuple[float, float]:
    return float(linear[..., :3].mean()), float(linear[..., 3].mean())


def _pixel(session: Session, preset: str, times: float) -> float:
    camera: Any = session.state("shells", preset, {}).camera
    return float(2 * camera.distance * times * math.tan(math.radians(camera.field_of_view) / 2) / LINES)


def sweeps(session: Session, presets: Sequence[str], techniques: str, times: float = 16.0) -> list[Plan]:
    """The camera steps back from each preset by a thousandth of its distance, where coarser voxels are read."""
    plans = []
    for preset in presets:
        camera: Any = seen(session, preset, times, {}).camera
        sets = {"camera.distance": camera.distance, "camera.field_of_view": camera.field_of_view}
        chosen: tuple[Choice, ...] = choices_of("shells", "filter", techniques)
        stride = CAMERA_STEP / PARAMETER_STEP
        width = max(16, round(LINES / times))
        plans.append(
            Plan("shells", preset, "camera.distance", "filter", chosen, sets, width, stride=stride).checked()
        )
    return plans


def table(lines: Sequence[Line]) -> str:
    """Brightness and opacity against the reference, in per cent, as Markdown."""
    far = list(dict.fromkeys(line.times for line in lines))
    heads = ["preset", "filter", *(f"{one:g} x" for one in far), "worst brightness", "worst opacity"]
    rows = ["| " + " | ".join(heads) + " |", "| --- | --- |" + " ---: |" * (len(far) + 2)]
    for preset, label in dict.fromkeys((line.preset, line.label) for line in lines):
        own = [line for line in lines if (line.preset, line.label) == (preset, label)]
        cells = [f"{100 * (one.brightness - 1):+.1f}, {100 * (one.opacity - 1):+.1f}" for one in own]
        worst = [max(abs(getattr(one, name) - 1) for one in own) for name in ("brightness", "opacity")]
        rows.append("| " + " | ".join([preset, label, *cells, *(f"{100 * one:.1f}" for one in worst)]) + " |")
    return "\n".join(rows) + "\n"


def chart(lines: Sequence[Line], title: str) -> Figure:
    """Brightness above, opacity below, a column a preset."""
    presets, labels = (list(dict.fromkeys(getattr(line, name) for line in lines)) for name in ("preset", "label"))
    figure = Figure(figsize=(4.2 * len(presets), 6), layout="constrained")
    figure.suptitle(title)
    axes = figure.subplots(2, len(presets), sharex=True, sharey="row", squeeze=False)
    for column, preset in enumerate(presets):
        for row, name in enumerate(("brightness", "opacity")):
            place = axes[row][column]
            for number, label in enumerate(labels):
                own = [line for line in lines if (line.preset, line.label) == (preset, label)]
                marks = "s:" if label in (DEFAULT, FIRST) else "o-"
                place.plot([line.times for line in own], [100 * (getattr(line, name) - 1) for line in own],
                           marks, color=COLOURS[number % len(COLOURS)], label=label)
            place.axhspan(-3, 3, color="0.9", zorder=0)
            place.set_xscale("log", base=2)
            far = list(dict.fromkeys(line.times for line in lines))
            place.set_xticks(far, [f"{one:g}" for one in far])
            place.minorticks_off()
            place.grid(True, alpha=0.3)
            if row == 0:
                place.set_title(preset)
            if column == 0:
                place.set_ylabel(f"{name}, % off the reference")
        axes[1][column].set_xlabel("times the preset's distance")
    figure.legend(*axes[0][0].get_legend_handles_labels(), loc="outside lower center", ncols=len(labels))
    return figure


def write(lines: Sequence[Line], folder: Path, title: str) -> str:
    """Write `FILES`; returns the table."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "results.json").write_text(json.dumps([asdict(line) for line in lines], indent=1), encoding="utf-8")
    said = (
        f"{title}\n\nEach cell: brightness and opacity against the reference, in per cent. Brightness is the mean "
        f"radiance of the preset's whole picture, opacity that of its shell without its surface. Pixels are those of "
        f"{LINES} lines; the reference has {JUDGED} x {JUDGED} px of 16 positions in every window. Filters are drawn "
        f"with light and a way to the sun at every sample; the default picture as it is, of {SETTLED} samples at "
        f"least.\n\n{table(lines)}"
    )
    (folder / "table.md").write_text(said, encoding="utf-8")
    figure = chart(lines, title)
    FigureCanvasAgg(figure)
    figure.savefig(folder / "distance.png", dpi=100, metadata={"Software": None})
    figure.savefig(folder / "distance.svg", metadata={"Date": None})
    return said
