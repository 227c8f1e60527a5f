"""The sky of the forest reference as a table over its upper hemisphere, from which directions are drawn.

Rows are equal steps in the sine of the elevation from the horizon up, columns equal steps in azimuth clockwise from
north, so that all cells have one solid angle; radiance is even within each.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def sky_table(radiance: Floats) -> tuple[Floats, Floats, float]:
    """What drawing directions needs of a table of radiance.

    Args:
        radiance: (E, A, 3), W m-2 sr-1.

    Returns:
        Shares of the light up to each row (E,), and up to each column within a row (E, A), both rising to 1; and the
        integral of the channels' mean over the hemisphere's solid angle, W m-2. All 0 where the sky is black.
    """
    mean = radiance.mean(axis=2)
    rows = mean.sum(axis=1)
    power = float(rows.sum()) * 2.0 * math.pi / mean.size
    if power <= 0.0:
        return np.zeros(len(mean)), np.zeros_like(mean), 0.0
    columns = np.cumsum(mean, axis=1) / np.maximum(rows, 1e-300)[:, None]
    return np.cumsum(rows) / rows.sum(), columns, power


def level_irradiance(radiance: Floats) -> Floats:
    """Irradiance (3,) of open level ground under a table of radiance (E, A, 3)."""
    sine = (np.arange(len(radiance)) + 0.5) / len(radiance)
    found: Floats = 2.0 * math.pi * (sine[:, None] * radiance.mean(axis=1)).mean(axis=0)
    return found
