"""How leaves' lobes fit, and what each coarser level of the pattern loses: tables and a chart by one command.

The truth of a level is what its finest voxels send, each by what an eye outside its block sees of it; eyes and suns are
others than those that the levels were fitted at. Errors are relative: root mean square of the difference over that of
the truth, over blocks weighted by what they show.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from renderer.core.technique import Arrays
from renderer.forest import lobe, lobe_levels, sggx
from renderer.forest.bakes import pattern_bake
from renderer.forest.leaf_optics import LEAVES, fitted_lobes, fitted_species
from renderer.forest.lobe_kernels import gather
from renderer.forest.pattern_mips import LEVELS
from renderer.forest.state import ForestState
from renderer.session import Session
from renderer.study.charts import COLOURS, MARKERS

Floats = NDArray[Any]
HELD_BACK = np.array(
    [(1, 1, 0), (1, -1, 0), (1, 0, 1), (1, 0, -1), (-1, 1, 0), (-1, 0, -1), (0, 1, -1), (0, -1, 1), (1, 2, 0)]
)
"""Whole voxels (k, j, i) towards the eyes of the truth: none that a lobe was fitted at."""

SUNS = 40

METHODS = {
    "averaged": "Lafortune, averaged",
    "refitted": "Lafortune, refitted",
    "mean normal": "thin leaves, mean normal",
    "sggx": "SGGX, averaged",
}


def write_fits(path: Path = lobe.FITS) -> dict[str, Any]:
    """Fit the lobes of leaves and hold them to three species; what is written is what the renderer then uses."""
    made: dict[str, Any] = {
        "recipe": {
            "by": "umbrage leaves fit",
            "leaf": "PROSPECT-D, Féret et al. 2017, of the package prosail; both sides Lambert's, Ross 1981",
            "colours": "linear sRGB, Wyman et al. 2013",
            "fit": "scipy least_squares over 100 eyes x 211 suns, dual_annealing where it stalls",
            "residual": "root mean square of the difference over that of the leaves",
        },
        "lobes": fitted_lobes(),
    }
    path.write_text(json.dumps({**made, "species": {}}, indent=1, ensure_ascii=False) + "\n")
    lobe.fitted.cache_clear()
    made["species"] = {name: fitted_species(name) for name in LEAVES}
    path.write_text(json.dumps(made, indent=1, ensure_ascii=False) + "\n")
    return made


def level_errors(pattern: Arrays, tell: Callable[[float, str], None]) -> list[dict[str, Any]]:
    """Relative error of each way of filtering, level by level.

    Returns:
        One row a level: `level`, `blocks` with matter, and the error of each of `METHODS`.
    """
    made = {
        name: lobe_levels.bake_lobes(
            {"levels": name}, {"pattern": pattern}, lambda share, words: tell(share / 2, words)
        )
        for name in ("averaged", "refitted")
    }
    flakes = sggx.bake_sggx({}, {"pattern": pattern}, lambda share, words: None)
    eyes, lengths = lobe_levels.towards(HELD_BACK)
    suns = lobe.directions(SUNS)
    depth = lobe_levels.depths(pattern["colour"])
    kind = lobe_levels.kinds_of(pattern["normal"], depth > 0)
    table = lobe_levels.table_of(eyes, suns)
    rows = []
    for level in [n for n in range(1, LEVELS + 1) if f"colour_{n}" in pattern]:
        tell(0.5 + 0.5 * level / (LEVELS + 1), f"comparing level {level}")
        errors, size, blocks = dict.fromkeys(METHODS, 0.0), 0.0, 0
        layers, *shape = made["averaged"][f"lobe_{level}"].shape[:3]
        for layer in range(layers):
            total = np.zeros((*shape, len(eyes), SUNS), np.float32)
            shown = np.zeros((*shape, len(eyes)), np.float32)
            gather(depth, kind, 2**level, layer, HELD_BACK, lengths.astype(np.float32), table, total, shown)
            full = shown.min(axis=-1) > 1e-3
            weight = shown[full][..., None]
            wanted = total[full] / weight
            found = _answers(pattern, made, flakes, level, layer, full, eyes, suns)
            for name, values in found.items():
                errors[name] += float((weight * (values - wanted) ** 2).sum())
            size += float((weight * wanted**2).sum())
            blocks += int(full.sum())
        rows.append({"level": level, "blocks": blocks, **{k: float(np.sqrt(v / size)) for k, v in errors.items()}})
    return rows


def _answers(
    pattern: Arrays,
    made: dict[str, Arrays],
    flakes: Arrays,
    level: int,
    layer: int,
    full: NDArray[np.bool_],
    eyes: Floats,
    suns: Floats,
) -> dict[str, Floats]:
    """What every method says that blocks of one layer reflect, (blocks, V, S)."""
    way, kappa = lobe_levels.mean_normals(pattern[f"normal_{level}"][layer][full])
    lit, seen = (way @ suns.T)[:, None, :], (way @ eyes.T)[:, :, None]
    lit, seen, cosine = np.broadcast_arrays(lit, seen, (eyes @ suns.T)[None])
    lobes = {
        name: lobe.lobe(lobe.decode(made[name][f"lobe_{level}"][layer][full])[:, None, None], lit, seen, cosine)
        for name in ("averaged", "refitted")
    }
    spread = sggx.decode(flakes[f"spread_{level}"][layer][full], flakes[f"lean_{level}"][layer][full])
    return {
        **lobes,
        "mean normal": lobe.leaves_reflect(kappa[:, None, None], lit, seen, cosine),
        "sggx": sggx.reflected(spread, eyes, suns),
    }


def table_of(rows: list[dict[str, Any]], species: dict[str, Any]) -> str:
    """Both results as Markdown."""
    lines = ["Relative error of what a block of voxels sends, by level (`umbrage leaves levels`).", ""]
    lines += ["| level | voxel | blocks | " + " | ".join(METHODS.values()) + " |", "| ---: " * (3 + len(METHODS)) + "|"]
    for row in rows:
        values = " | ".join(f"{row[name]:.3f}" for name in METHODS)
        lines.append(f"| {row['level']} | {0.625 * 2 ** row['level']:g} m | {row['blocks']} | {values} |")
    lines += ["", "Relative residual of one voxel's leaves (`umbrage leaves fit`, PROSPECT-D).", ""]
    lines += [
        "| species | agreement | fitted lobe | thesis' lobe, best gain | Lambert |",
        "| --- " + "| ---: " * 4 + "|",
    ]
    for one in species.values():
        values = " | ".join(f"{one['residuals'][kind]:.3f}" for kind in ("fitted", "thesis", "lambert"))
        lines.append(f"| {one['title']} | {one['agreement']:.2f} | {values} |")
    return "\n".join(lines) + "\n"


def chart_of(rows: list[dict[str, Any]], folder: Path) -> None:
    """Error against level, one line a method."""
    figure = Figure(figsize=(6.4, 4.0), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    for (name, label), colour, marker in zip(METHODS.items(), COLOURS, MARKERS, strict=False):
        axes.plot([row["level"] for row in rows], [row[name] for row in rows], marker=marker, color=colour, label=label)
    axes.set(xlabel="level (voxels twice as wide each)", ylabel="relative error of what a block sends", ylim=(0, None))
    axes.set_xticks([row["level"] for row in rows])
    figure.legend(loc="outside upper center", ncols=2)
    axes.grid(alpha=0.3)
    for end in ("svg", "png"):
        figure.savefig(folder / f"levels.{end}", dpi=150)


def run_levels(session: Session, folder: Path, tell: Callable[[float, str], None]) -> str:
    """Measure every level of the default forest; leaves `levels.json`, `levels.md` and the chart in a folder."""

    pattern = session.compute(pattern_bake(ForestState()))
    rows = level_errors(pattern, tell)
    species = json.loads(lobe.FITS.read_text())["species"]
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "levels.json").write_text(json.dumps({"by": "umbrage leaves levels", "levels": rows}, indent=1) + "\n")
    text = table_of(rows, species)
    (folder / "levels.md").write_text(text)
    chart_of(rows, folder)
    return text
