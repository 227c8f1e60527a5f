"""How steady a picture is while one thing moves: flicker, its table, its chart, and the frames where it is worst.

Knows no phenomenon and draws nothing: it is given the converged pictures and the references of a sweep.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from renderer.core.errors import InputError
from renderer.study.charts import COLOURS

STEPS = 16
"""Steps of a sweep: one picture more."""

WIDTH = 128
"""Pixels across of the stated figures."""

SHOWN = 256
"""Pixels across, at least, of each picture of a strip."""

Pictures = Sequence[NDArray[np.floating]]


@dataclass(frozen=True)
class Flicker:
    """What changes in a sweep that does not change in the truth, relative to the truth's mean.

    Attributes:
        value: root mean square over steps, pixels and channels.
        worst: of the worst step. worst_step: its number, from 0.
        steps: of each step.
        truth: what the truth itself changes by, root mean square over all steps.
        map: (H, W) signed difference of the worst step, mean over the channels, relative to the truth's mean.
    """

    value: float
    worst: float
    worst_step: int
    steps: tuple[float, ...]
    truth: float
    map: NDArray[np.float64]


def flicker(pictures: Pictures, references: Pictures) -> Flicker:
    """Flicker of the pictures of a sweep: rms of ((I[k+1] - I[k]) - (R[k+1] - R[k])) / mean(R).

    Args:
        pictures, references: (H, W, 3 or 4) linear radiance of each place of the sweep, in turn; alpha has no part.

    Raises:
        InputError: fewer than two places, unequal numbers or shapes, or black references.
    """
    if len(pictures) != len(references) or len(pictures) < 2:
        raise InputError(
            "pictures", f"{len(pictures)} of them, and {len(references)} references", "as many, two or more"
        )
    if len({picture[..., :3].shape for picture in (*pictures, *references)}) != 1:
        raise InputError("pictures", "have several shapes", "one (H, W, 3 or 4)")
    images, truths = (np.stack([p[..., :3] for p in given]).astype(np.float64) for given in (pictures, references))
    mean = float(truths.mean())
    if mean <= 0:
        raise InputError("references", "are black: a flicker relative to their mean has no meaning")
    moved = np.diff(truths, axis=0) / mean
    strays = np.diff(images, axis=0) / mean - moved
    steps = np.sqrt((strays**2).mean(axis=(1, 2, 3)))
    worst = int(steps.argmax())
    return Flicker(
        float(np.sqrt((steps**2).mean())),
        float(steps[worst]),
        worst,
        tuple(map(float, steps)),
        float(np.sqrt((moved**2).mean())),
        strays[worst].mean(axis=-1),
    )


def table(lines: Sequence[Mapping[str, Any]]) -> str:
    """Results as Markdown, the steadiest first within each sweep."""
    heads = ["preset", "sweep", "technique", "flicker", "worst step", "one frame's flicker", "its worst step",
             "the truth moves by", "reference's own error", "pixels, steps"]  # fmt: skip
    rows = ["| " + " | ".join(heads) + " |", "|" + " --- |" * 3 + " ---: |" * 7]
    for line in sorted(lines, key=lambda one: (one["preset"], one["sweep"], one["flicker"])):
        found = [line["flicker"], line["worst"], line["once"]["flicker"], line["once"]["worst"], line["truth"],
                 line["reference_standard_error"]]  # fmt: skip
        rows.append(
            "| "
            + " | ".join([line["preset"], line["sweep"], line["label"], *(f"{v:.4f}" for v in found)])
            + f" | {line['size'][0]} x {line['size'][1]}, {line['steps']} |"
        )
    return "\n".join(rows) + "\n"


def chart(lines: Sequence[Mapping[str, Any]], title: str) -> Figure:
    """Flicker of each technique, one group of bars a sweep; a tick marks the worst step."""
    sweeps = list(dict.fromkeys(f"{line['preset']}, {line['sweep']}" for line in lines))
    labels = list(dict.fromkeys(line["label"] for line in lines))
    figure = Figure(figsize=(3 + 1.1 * len(sweeps) * max(2, len(labels) / 2), 4.5), layout="constrained")
    figure.suptitle(title)
    axes = figure.add_subplot(ylabel="flicker, relative to the reference's mean", yscale="log")
    width = 0.8 / len(labels)
    for number, label in enumerate(labels):
        held = [(sweeps.index(f"{one['preset']}, {one['sweep']}"), one) for one in lines if one["label"] == label]
        places = [place + (number + 0.5) * width - 0.4 for place, _ in held]
        axes.bar(places, [one["flicker"] for _, one in held], width, color=COLOURS[number % len(COLOURS)], label=label)
        axes.plot(places, [one["worst"] for _, one in held], "_", color="black")
    axes.set_xticks(range(len(sweeps)), sweeps)
    axes.grid(True, axis="y", alpha=0.3)
    axes.legend(fontsize="small", loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def changes(found: Sequence[Flicker], width: int) -> list[NDArray[np.uint8]]:
    """What changed in each worst step though the truth did not: blue darker, red brighter, on one scale for all.

    Args:
        found: of pictures of one size. width: of what is returned, at least, pixels.
    """
    limit = max(*(float(np.percentile(np.abs(one.map), 99)) for one in found), 1e-4)
    larger = -(-width // found[0].map.shape[1])
    return [_signed(one, limit).repeat(larger, axis=0).repeat(larger, axis=1) for one in found]


def _signed(found: Flicker, limit: float) -> NDArray[np.uint8]:
    """Its map in colours that saturate at `limit`, (H, W, 3)."""
    scaled = np.clip(found.map / limit, -1, 1) / 2 + 0.5
    coloured: NDArray[np.uint8] = matplotlib.colormaps["RdBu_r"](scaled, bytes=True)[..., :3]
    return coloured


def strip(before: NDArray[np.uint8], after: NDArray[np.uint8], found: Flicker, top: float = 0.0) -> NDArray[np.uint8]:
    """The worst step as displayed: the picture before, after, and what changed though the truth did not.

    Args:
        before, after: (H, W, 3). found: of the same pictures.
        top: value at which the signed scale (blue darker, red brighter) saturates; its 99th percentile where 0.

    Returns:
        (H, 3 W, 3) uint8, each pixel drawn as often as makes a picture at least `SHOWN` wide.
    """
    limit = top or max(float(np.percentile(np.abs(found.map), 99)), 1e-4)
    whole = np.concatenate([before, after, _signed(found, limit)], axis=1)
    larger = -(-SHOWN // before.shape[1])
    return np.ascontiguousarray(whole.repeat(larger, axis=0).repeat(larger, axis=1), np.uint8)


def write(lines: Sequence[Mapping[str, Any]], folder: Path, title: str) -> None:
    """Table and chart of some results: `table.md`, `flicker.png` and `flicker.svg`."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "table.md").write_text(f"{title}\n\n{table(lines)}", encoding="utf-8")
    figure = chart(lines, title)
    FigureCanvasAgg(figure)
    figure.savefig(folder / "flicker.png", dpi=120, metadata={"Software": None})
    figure.savefig(folder / "flicker.svg", metadata={"Date": None})
