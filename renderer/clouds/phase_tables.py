"""Phase functions as arrays: moments for the solvers of transport, tables over the angle for the shaders.

A table's angles lie close where the phase function is sharp: at the forward peak and the glory their step is about 0.02
degrees, at the fogbow 0.1 degrees (formulas a1).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from renderer.clouds.droplets import band_scattering
from renderer.clouds.legendre import disc_moments, share_within, values_of
from renderer.core.technique import Arrays

Progress = Callable[[float, str], None]

TABLE = 2048
"""Angles of a table."""

FORWARD_ANGLE = np.radians(5.0)
"""Deviation that counts as the forward peak (Belcour 2009, section 4.3.1), rad."""

SUN_RADIUS = np.radians(0.533 / 2)
"""Angular radius of the sun, rad."""

NEGLIGIBLE = 1e-9
"""Moments below it are left out."""


def table_cosines(count: int = TABLE) -> np.ndarray:
    """Cosines of a table's entries: those of the fourth power of the distance from either end."""
    u = np.linspace(0.0, 1.0, count)
    return np.where(u <= 0.5, 1 - (2 * u) ** 4, (2 - 2 * u) ** 4 - 1)


def table_place(cosines: np.ndarray, count: int = TABLE) -> np.ndarray:
    """Fractional entry of each cosine in a table: the inverse of `table_cosines`."""
    half = 0.5 * np.sqrt(np.sqrt(np.maximum(1 - np.abs(cosines), 0)))
    return np.where(cosines > 0, half, 1 - half) * (count - 1)


def look_up(table: np.ndarray, cosines: np.ndarray) -> np.ndarray:
    """A table (TABLE, ..) at cosines of any shape, linearly between entries: the twin of the shaders' fetch."""
    place = table_place(np.asarray(cosines, np.float64), len(table))
    low = np.minimum(place.astype(int), len(table) - 2)
    share = (place - low).reshape(place.shape + (1,) * (table.ndim - 1))
    return table[low] * (1 - share) + table[low + 1] * share


def phase_arrays(moments: np.ndarray, sun_radius: float = 0.0) -> dict[str, np.ndarray]:
    """What every phase technique's bake holds.

    Args:
        moments: (3, L) in each band.
        sun_radius: of the sun's disc, over which the tables are averaged, rad; 0 for a point.

    Returns:
        `moments` (3, L) without the sun's disc; `disc` (L,), the disc's own; `value` and `twice` (TABLE, 3), the phase
        function and its convolution with itself, 1/sr; `asymmetry` (3,); `forward` (3,), the share within
        FORWARD_ANGLE, and `spread` (3,), the mean square angle of that share, rad^2.
    """
    kept = max(int(np.flatnonzero(np.abs(moments).max(axis=0) > NEGLIGIBLE).max()) + 1, 2)
    moments = moments[:, :kept]
    cosines, disc = table_cosines(), disc_moments(kept, sun_radius)
    return {
        "moments": moments,
        "disc": disc,
        "value": np.stack([values_of(band * disc, cosines) for band in moments], axis=1).astype(np.float32),
        "twice": np.stack([values_of(band**2 * disc, cosines) for band in moments], axis=1).astype(np.float32),
        "asymmetry": moments[:, 1],
        "forward": np.array([share_within(band, FORWARD_ANGLE) for band in moments]),
        "spread": np.array([_peak_spread(band) for band in moments]),
    }


def _peak_spread(moments: np.ndarray) -> float:
    """Mean square angle of what is scattered by less than FORWARD_ANGLE, rad^2."""
    angles = np.linspace(0, FORWARD_ANGLE, 400)
    weight = values_of(moments, np.cos(angles)) * np.sin(angles)
    return float((weight * angles**2).sum() / weight.sum())


def bake_droplets(arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Progress) -> Arrays:
    """Bake Mie's phase function of droplets: `phase_arrays`, with `efficiency`, `albedo` and `effective_radius_m`.

    Args:
        arguments: of `Droplets`, and `sun_disc`.
    """
    droplets = {name: value for name, value in arguments.items() if name != "sun_disc"}
    found = band_scattering(droplets, progress)
    tables = phase_arrays(found["moments"], SUN_RADIUS if arguments["sun_disc"] else 0.0)
    return {**tables, **{name: found[name] for name in ("efficiency", "albedo", "effective_radius_m")}}


def bake_moments(arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Progress) -> Arrays:
    """Bake a phase function that is the same in every band, given by its `moments`."""
    return phase_arrays(np.tile(np.array(arguments["moments"], np.float64), (3, 1)))
