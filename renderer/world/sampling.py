"""Sub-pixel positions of a picture's samples."""

from __future__ import annotations

import numpy as np

PLASTIC = (0.7548776662466927, 0.5698402909980532)
"""Roberts 2018, the R2 low-discrepancy sequence: inverse powers of the plastic number."""


def offset(sample: int) -> tuple[float, float]:
    """Place of a sample inside its pixel, from the top-left corner; sample 0 is the pixel's centre."""
    return (0.5 + sample * PLASTIC[0]) % 1.0, (0.5 + sample * PLASTIC[1]) % 1.0


def offsets(count: int) -> np.ndarray:
    """Places of the first `count` samples, (count, 2) float64."""
    return np.array([offset(sample) for sample in range(count)])
