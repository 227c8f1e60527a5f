"""Where a cloud's fogbow and glory stand, read off the moments of a phase function."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from renderer.clouds.legendre import disc_moments, values_of

STEP = np.radians(0.01)
"""Step of the angles that are searched, rad."""

FOGBOW = (np.radians(30.0), np.radians(50.0))
"""Distance from the antisolar point at which a fogbow may stand, rad."""

GLORY = np.radians(10.0)
"""Distance from the antisolar point within which rings count as the glory's, rad."""


@dataclass(frozen=True)
class Bows:
    """Angular radii around the antisolar point, rad.

    Attributes:
        fogbow: of the brightest part of the white bow; NaN where there is none.
        glory: of the glory's bright rings, inside first.
    """

    fogbow: float
    glory: tuple[float, ...]


def bows(moments: np.ndarray, sun_radius: float) -> Bows:
    """Fogbow and glory of one band.

    Args:
        moments: (L,) of the phase function.
        sun_radius: angular radius of the sun's disc that blurs them, rad.
    """
    blurred = moments * disc_moments(len(moments), sun_radius)

    def bright(low: float, high: float) -> tuple[np.ndarray, np.ndarray]:
        away = np.arange(low, high, STEP)
        values = values_of(blurred, -np.cos(away))
        inner = values[1:-1]
        peaks = 1 + np.flatnonzero((inner > values[:-2]) & (inner >= values[2:]))
        return away[peaks], values[peaks]

    places, heights = bright(*FOGBOW)
    rings, _ = bright(STEP / 2, GLORY)
    fogbow = float(places[np.argmax(heights)]) if len(places) else float("nan")
    return Bows(fogbow, tuple(float(ring) for ring in rings))
