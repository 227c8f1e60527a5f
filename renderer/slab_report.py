"""Tables and charts of `renderer.slab_study`, and the folder that holds them with the raw results."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from renderer import slab_study as study
from renderer.core.cache import Cache
from renderer.core.registry import techniques
from renderer.study.charts import COLOURS, plain_axes, save

Lines = list[dict[str, Any]]
FILES = ("table.md", "errors.png", "errors.svg", "orders.png", "orders.svg", "results.jsonl")
"""What the documentation keeps."""

ORDER = ("adding_doubling", "orders", "delta_eddington", "thesis_orders", "single")
FORWARD = {650: 46.4, 550: 47.1, 450: 49.6}
"""Printed share of the forward peak for 1 % width, per cent (errata 001-23)."""

FOGBOW = {("normal", 0.01): (38.45, 38.8, 38.0), ("normal", 0.1): (38.2, 38.35, 38.2),
          ("lognormal", 0.1): (38.3, 38.35, 38.15)}
GLORY = {650: (1.8, 3.85, 5.7), 550: (1.55, 3.25, 4.85), 450: (1.25, 2.7, 4.0)}
"""Radii of an independent evaluation by the same bands, degrees."""


def run(folder: Path, photons: int, tell: Callable[[float, str], None]) -> str:
    """Measure everything, and leave raw results, table and charts in a folder.

    Args:
        folder: made where it is missing.
        photons: of each slab.
        tell: told the share done; may raise `Cancelled`.

    Returns:
        The table.
    """
    cache = Cache()

    def part(low: float, high: float) -> Callable[[float, str], None]:
        return lambda share, words: tell(low + (high - low) * share, words)

    parts: dict[str, Lines] = {
        "errors": study.technique_errors(photons, cache, part(0.0, 0.7)),
        "orders": study.order_numbers(photons, cache, part(0.7, 0.8)),
        "lobe": study.lobe_numbers(photons, cache, part(0.8, 0.9)),
        "droplets": study.droplet_numbers(part(0.9, 0.95)),
        "sphere": study.sphere_numbers(photons, part(0.95, 1.0)),
        "contrast": study.contrast_numbers(),
        "path": study.path_numbers(),
    }
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "results.jsonl").open("w", encoding="utf-8") as file:
        for name, lines in parts.items():
            file.writelines(json.dumps({"part": name, "photons": photons, **line}) + "\n" for line in lines)
    text = table(parts, photons)
    (folder / "table.md").write_text(text, encoding="utf-8")
    for name, figure in (("errors", errors_chart(parts["errors"])), ("orders", orders_chart(parts["orders"]))):
        save(figure, folder, name)
    return text


def table(parts: dict[str, Lines], photons: int) -> str:
    """All of it as Markdown."""
    sections = [
        f"Scattering in a plane cloud, against {photons:,} photons a slab (`umbrage study clouds --slab`); droplets of "
        "10 µm, 10 % wide, 650 nm, optical depths 0.5 to 128, cosines of the sun 0.1 to 1. Flux in shares of the beam; "
        "radiance: median of the relative error over directions, and root mean square over the mean without the "
        "photons' "
        "noise, both the median over depths and suns; bins within 15 degrees of the sun left out. The last columns "
        "hold the "
        "techniques to the solver without tables, which has no noise, in 130 directions.",
        _techniques(parts["errors"]),
        "Order 2 of the sunlit side, hemispherical share of the beam: droplets of effective radius 7 µm (formulas "
        "a4). The "
        "printed factor is about twice too bright (errata 001-16).",
        _orders(parts["orders"]),
        "Radiance of order 2 over that of the photons: Henyey-Greenstein 0.85, sun at 0.7, view at 0.6 to 0.7. In "
        "brackets what another Monte Carlo found (errata 001-16).",
        _lobe(parts["lobe"]),
        "Droplets of 10 µm: share of the light scattered by less than 5 degrees, and radii of fogbow and glory from "
        "the "
        "antisolar point, the sun's disc averaged. In brackets what another evaluation found.",
        _droplets(parts["droplets"]),
        "Order 1 of the plane's closed form over that of a sphere, less 1, both angles equal, a layer of 250 m at "
        "2,500 m "
        "(errata 001-18); and the share that all orders send back, 100 m of optical depth 8, in photons.",
        _sphere(parts["sphere"]),
        "Fogbow against the cloud 8 degrees beside it, and the glory's first ring against the dark one outside it, "
        "in order 1, "
        "sun's disc averaged: 1 where a phase function knows neither.",
        _rows(("phase function", "fogbow", "glory"),
              [[line["phase"], f"{line['bow']:.2f}", f"{line['ring']:.2f}"] for line in parts["contrast"]]),
        "Metres of a ray in 250 m of cloud by its angle at the top: a plane's go to infinity at the horizon.",
        _rows(("angle", "plane", "sphere"),
              [[f"{line['degrees']:g}°", f"{line['plane']:,.0f}", f"{line['sphere']:,.0f}"] for line in parts["path"]]),
    ]
    return "\n\n".join(sections) + "\n"


def _rows(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = ["| " + " | ".join(heads) + " |", "| --- " + "| ---: " * (len(heads) - 1) + "|"]
    return "\n".join([*lines, *("| " + " | ".join(row) + " |" for row in rows)])


def _percent(share: float) -> str:
    return f"{100 * share:.2g} %" if share < 0.1 else f"{100 * share:.0f} %"


def _techniques(lines: Lines) -> str:
    rows = []
    for kind in ORDER:
        own = [line for line in lines if line["technique"] == kind]
        high = [line for line in own if line["sun"] >= 0.4]
        rows.append([kind, *(f"{max(abs(line['off_reflectance']) for line in some):.4f}" for some in (own, high)),
                     f"{max(abs(line['off_transmittance']) for line in own):.4f}",
                     f"{max(abs(line['reflectance'] + line['transmittance'] - 1) for line in own):.1g}",
                     *(f"{100 * np.nanmedian([line[side][name] for line in own]):.1f} %"
                       for side in ("up", "down") for name in ("median", "rms")),
                     f"{max(line['solver'][0] for line in own):.4f}",
                     *(f"{_percent(np.median([line['solver'][side] for line in own]))} "
                       f"({_percent(max(line['solver'][side] for line in own))})" for side in (1, 2))])
    noise = [line for line in lines if line["technique"] == ORDER[0]]
    rows.append(["the photons' own error", *[f"{max(line['standard_error'] for line in noise):.4f}"] * 3, "0",
                 *(cell for side in ("up", "down")
                   for cell in (f"{100 * np.nanmedian([line[side]['noise'] for line in noise]):.1f} %", "-")),
                 "-", "-", "-"])
    return _rows(("technique", "worst reflectance", "sun at 0.4 and more", "worst transmittance", "R + T - 1",
                  "radiance up", "rms", "radiance down", "rms", "solver: worst reflectance", "radiance up (worst)",
                  "radiance down (worst)"), rows)


def _orders(lines: Lines) -> str:
    rows = [[f"{line['depth']:g}", f"{line['sun']:g}", f"{line['first'][0]:.4f} ± {line['first'][1]:.4f}",
             f"{line['first_form']:.4f}", f"{line['second'][0]:.4f} ± {line['second'][1]:.4f}", f"{line['thesis']:.4f}",
             f"{line['corrected']:.4f}", f"{line['thesis'] / line['second'][0]:.2f}",
             f"{line['corrected'] / line['second'][0]:.2f}"] for line in lines]
    return _rows(("optical depth", "sun", "order 1, photons", "closed form", "order 2, photons", "printed", "corrected",
                  "printed / photons", "corrected / photons"), rows)


def _lobe(lines: Lines) -> str:
    rows = []
    for line in lines:
        ratios = (f"{line[name]:.2f} ({line[f'{name}_known']:g})" for name in ("thesis", "corrected"))
        rows.append([f"{line['depth']:g}", *ratios, f"{100 * line['noise']:.1f} %"])
    return _rows(("optical depth", "printed", "corrected", "photons' error"), rows)


def _droplets(lines: Lines) -> str:
    rows = []
    for number, line in enumerate(lines):
        narrow = line["width"] == 0.01
        share = f" ({FORWARD[line['nm']]} %)" if narrow else ""
        rings = ", ".join(f"{ring:.2f}" for ring in line["glory"])
        known = f" ({', '.join(map(str, GLORY[line['nm']]))})" if narrow else ""
        bow = FOGBOW[line["distribution"], line["width"]][number % 3]
        rows.append([f"{line['distribution']}, {100 * line['width']:g} %", f"{line['nm']}", f"{line['g']:.4f}",
                     f"{100 * line['forward']:.1f} %{share}", f"{line['fogbow']:.2f}° ({bow})", f"{rings}°{known}"])
    return _rows(("radii", "nm", "asymmetry", "within 5 degrees", "fogbow", "glory"), rows)


def _sphere(lines: Lines) -> str:
    single = [[f"order 1, {line['extinction']:g} /m", f"{line['degrees']:g}°", f"{line['off']:.1e}", "", ""]
              for line in lines if line["kind"] == "single"]
    every = [["all orders, 0.08 /m", f"{np.degrees(np.arccos(line['sun'])):.1f}°", "",
              *(f"{line[name][0]:.4f} ± {line[name][1]:.4f}" for name in ("plane", "sphere"))]
             for line in lines if line["kind"] == "all"]
    return _rows(("light", "sun from the zenith", "plane over sphere, less 1", "plane sends back", "sphere sends back"),
                 [*single, *every])


def errors_chart(lines: Lines) -> Figure:
    """Error of each technique over optical depth and sun: of reflectance, and of radiance on either side."""
    titles = {kind: techniques("clouds", "scattering")[kind].title for kind in ORDER}
    figure = Figure(figsize=(11, 8.6), layout="constrained")
    panels = figure.subplots(len(ORDER), 3, sharex=True, sharey=True)
    whats: tuple[tuple[str, Callable[[dict[str, Any]], float]], ...] = (
        ("reflectance, share of the beam", lambda line: abs(line["off_reflectance"])),
        ("radiance up, median relative error", lambda line: line["up"]["median"]),
        ("radiance down, median relative error", lambda line: line["down"]["median"]),
    )
    image = None
    for row, kind in enumerate(ORDER):
        own = {(line["sun"], line["depth"]): line for line in lines if line["technique"] == kind}
        for column, (what, value) in enumerate(whats):
            grid = np.array([[value(own[sun, depth]) for depth in study.DEPTHS] for sun in study.SUNS])
            axes = panels[row, column]
            shown = np.maximum(grid, 1e-3)
            image = axes.imshow(shown, norm=LogNorm(1e-3, 1), cmap="viridis", origin="lower", aspect="auto")
            for (y, x), found in np.ndenumerate(grid):
                axes.text(x, y, f"{found:.1%}" if found < 0.1 else f"{found:.0%}", ha="center", va="center", fontsize=6,
                          color="white" if found < 0.05 else "black")
            axes.set_xticks(range(len(study.DEPTHS)), [f"{depth:g}" for depth in study.DEPTHS])
            axes.set_yticks(range(len(study.SUNS)), [f"{sun:g}" for sun in study.SUNS])
            if row == 0:
                axes.set_title(what, fontsize=9)
            if column == 0:
                axes.set_ylabel(f"{titles[kind]}\ncosine of the sun", fontsize=8)
            if row == len(ORDER) - 1:
                axes.set_xlabel("optical depth", fontsize=8)
    assert image is not None
    figure.colorbar(image, ax=panels, label="error; the photons' own is in the table", shrink=0.6)
    return figure


def orders_chart(lines: Lines) -> Figure:
    """Order 2, printed and corrected, over that of the photons."""
    figure = Figure(figsize=(6.4, 4.0), layout="constrained")
    axes = figure.add_subplot(xscale="log", yscale="log", xlabel="optical depth along both rays, tau (1 / sun + 1)",
                              ylabel="order 2 over that of the photons",
                              title="Double scattering on the sunlit side")
    chosen = sorted(lines, key=lambda line: line["depth"] * (1 / line["sun"] + 1))
    paths = [line["depth"] * (1 / line["sun"] + 1) for line in chosen]
    for name, label, colour in (("thesis", "as printed", COLOURS[1]), ("corrected", "corrected", COLOURS[0])):
        ratios = [line[name] / line["second"][0] for line in chosen]
        errors = [line[name] / line["second"][0] * line["second"][1] / line["second"][0] for line in chosen]
        axes.errorbar(paths, ratios, yerr=errors, marker="o", color=colour, label=label, capsize=3)
    axes.axhline(1, color="black", linewidth=1)
    plain_axes(axes)
    axes.legend()
    return figure
