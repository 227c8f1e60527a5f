"""What few values keep of the light's way through a pattern of trees: how the Fourier series was chosen."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from renderer.core.technique import Arrays
from renderer.forest.transmittance import extinction_of
from renderer.forest.world_scale import CANOPY_HEIGHT, TILE_SIDE

PLACES = 512
"""Places along each line."""

DARK = 5.0
"""Optical depth behind which nothing is gathered any more, as in the pass: opaque wood would ring."""


@dataclass(frozen=True)
class Lines:
    """Ways of the light through a pattern.

    Attributes:
        depth: (N, PLACES) optical depth of each piece of the way [-].
        through: (N, PLACES) true transmittance to the middle of each piece.
    """

    depth: np.ndarray
    through: np.ndarray

    @property
    def d(self) -> np.ndarray:
        """Places (PLACES,) on the way, 0 where it begins, 1 on the ground."""
        return (np.arange(PLACES) + 0.5) / PLACES


def lines_through(pattern: Arrays, elevation: float, count: int = 1500, seed: int = 1, whole: bool = False) -> Lines:
    """Lines of a sun `elevation` degrees high at random places and azimuths, over level ground and the atlas' torus.

    They begin at their first matter, or at the layer's top if `whole`.
    """
    rng = np.random.default_rng(seed)
    extinction = extinction_of(pattern["colour"][..., 3])[0]
    azimuth = rng.uniform(0, 2 * np.pi, count)
    slope = np.tan(np.radians(elevation))
    start = rng.uniform(0, 4 * TILE_SIDE, (count, 2))

    def along(fall: np.ndarray) -> np.ndarray:
        """Extinction (count, P) where the lines have fallen so far [m]."""
        x = start[:, :1] + np.sin(azimuth)[:, None] * fall / slope
        y = start[:, 1:] + np.cos(azimuth)[:, None] * fall / slope
        v = y / (TILE_SIDE * np.sqrt(0.75))
        place = np.stack([v, x / TILE_SIDE - v / 2]) / 4 % 1
        layers, rows, columns = extinction.shape
        k = np.clip((1 - fall / CANOPY_HEIGHT) * layers, 0, layers - 1).astype(int)
        j, i = (place * np.array([rows, columns])[:, None, None]).astype(int)
        return np.asarray(extinction[k, j % rows, i % columns], np.float64)

    fall = np.broadcast_to((np.arange(PLACES) + 0.5) / PLACES * CANOPY_HEIGHT, (count, PLACES))
    met = along(fall) > 0
    first = np.where(met.any(axis=1) & (not whole), fall[np.arange(count), met.argmax(axis=1)], 0.0)[:, None]
    fall = first + (CANOPY_HEIGHT - first) * (np.arange(PLACES) + 0.5) / PLACES
    depth = along(fall) * (CANOPY_HEIGHT - first) / PLACES / np.sin(np.radians(elevation))
    return Lines(depth, np.exp(-(depth.cumsum(axis=1) - depth / 2)))


def coefficients(depth: np.ndarray, waves: int) -> np.ndarray:
    """a_0, a_1, b_1, ... (N, 1 + 2 waves) of optical depths (N, P) spread evenly over the way.

    Source: Jansen & Bavoil 2010, section 3; formulas h.
    """
    d = (np.arange(depth.shape[1]) + 0.5) / depth.shape[1]
    made = [2 * depth.sum(axis=1)]
    for k in range(1, waves + 1):
        made += [2 * depth @ np.cos(2 * np.pi * k * d), 2 * depth @ np.sin(2 * np.pi * k * d)]
    return np.stack(made, axis=1)


def series(values: np.ndarray, d: np.ndarray, damping: float = 0.0) -> np.ndarray:
    """Optical depth (N, P) at places (P,) or (N, P) from coefficients (N, 1 + 2 waves), before it is clamped."""
    waves = (values.shape[1] - 1) // 2
    tau = values[:, :1] * d / 2
    for k in range(1, waves + 1):
        weight = np.exp(-damping * (k / waves) ** 2) / (2 * np.pi * k)
        pair = values[:, 2 * k - 1, None] * np.sin(2 * np.pi * k * d)
        tau = tau + weight * (pair + values[:, 2 * k, None] * (1 - np.cos(2 * np.pi * k * d)))
    return np.asarray(tau)


def by_series(lines: Lines, count: int, damping: float = 0.0) -> np.ndarray:
    """Transmittance (N, PLACES) from `count` values of a Fourier series."""
    gathered = np.diff(np.minimum(lines.depth.cumsum(axis=1), DARK), axis=1, prepend=0)
    return np.exp(-np.maximum(series(coefficients(gathered, (count - 1) // 2), lines.d, damping), 0))


def by_sums(lines: Lines, count: int) -> np.ndarray:
    """Transmittance (N, PLACES) from `count` prefix sums at even distances, linear between them."""
    total = np.pad(lines.depth.cumsum(axis=1), ((0, 0), (1, 0)))
    known = np.linspace(0, 1, count + 1)
    kept = np.stack([np.interp(known, np.linspace(0, 1, PLACES + 1), row) for row in total])
    return np.exp(-np.stack([np.interp(lines.d, known, row) for row in kept]))


def rms(lines: Lines, found: np.ndarray, by: str) -> float:
    """Root mean square error of the transmittance.

    Args:
        by: what counts, every place ("all"), those with matter ("leaves"), or each by the light it stops ("light"),
            which is what a picture shows.
    """
    weight = {"all": np.ones(lines.depth.shape), "leaves": lines.depth > 0, "light": lines.depth * lines.through}[by]
    return float(np.sqrt((weight * (found - lines.through) ** 2).sum() / weight.sum()))


def rise(found: np.ndarray) -> float:
    """By how much a transmittance rises again along its way, at most, in 99 of 100 lines: true light only falls."""
    return float(np.quantile((found - np.minimum.accumulate(found, axis=1)).max(axis=1), 0.99))


METHODS: dict[str, Callable[[Lines], np.ndarray]] = {
    **{f"series of {n}": partial(by_series, count=n) for n in (3, 7, 11, 15)},
    "series of 15, damped": partial(by_series, count=15, damping=1.0),
    **{f"{n} prefix sums": partial(by_sums, count=n) for n in (8, 16)},
}


def table(pattern: Arrays, elevations: tuple[float, ...] = (18.0, 38.0, 62.0)) -> str:
    """The measurement as Markdown."""
    over = ("all", "leaves", "light")
    head = " | ".join(f"{e:g}°, {by}" for e in elevations for by in over)
    rows = [f"| kept | {head} | rises again, {elevations[0]:g}° |"]
    rows.append("| --- |" + " ---: |" * (3 * len(elevations) + 1))
    for whole in (False, True):
        bundles = [lines_through(pattern, e, whole=whole) for e in elevations]
        for name, method in METHODS.items():
            if whole and "15" not in name and "16" not in name:
                continue
            found = [method(lines) for lines in bundles]
            errors = [f"{rms(lines, f, by):.3f}" for lines, f in zip(bundles, found, strict=True) for by in over]
            rows.append(f"| {name}{', whole layer' * whole} | {' | '.join(errors)} | {rise(found[0]):.3f} |")
    return "\n".join(rows) + "\n"
