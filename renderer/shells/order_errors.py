"""How wrong a picture is whose cells were put together in the wrong order."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

STEP = 1 / 255
"""Difference from which a pixel counts as wrong: a step of eight bits, of opacity or of the brightest light."""


@dataclass(frozen=True)
class OrderError:
    """Of a picture against the same one in the exact order.

    Attributes:
        wrong: share of the pixels that show matter in either of them that differ by more than a tolerance.
        relative_rmse: root of the mean squared difference of their light, over that of the exact picture.
        worst: greatest difference of a channel, in units of the brightest light, or of opacity.
    """

    wrong: float
    relative_rmse: float
    worst: float


def order_error(picture: np.ndarray, exact: np.ndarray, tolerance: float = STEP) -> OrderError:
    """Compare two pictures without a background, or both with the same.

    Args:
        picture, exact: (H, W, 4) premultiplied radiance and opacity. tolerance: share of the brightest light of
            `exact` (its 99.5th percentile, so that a sparkle does not excuse the rest), and of opacity 1.
    """
    found, truth = picture.astype(np.float64), exact.astype(np.float64)
    shown = (found[..., 3] > 0) | (truth[..., 3] > 0)
    if not shown.any():
        return OrderError(0.0, 0.0, 0.0)
    brightest = float(np.percentile(truth[shown][:, :3], 99.5)) or 1.0
    gap = np.abs(found - truth)[shown]
    gap[:, :3] /= brightest
    largest = gap.max(axis=1)
    power = float((truth[..., :3] ** 2).mean())
    squared = float(((found - truth)[..., :3] ** 2).mean())
    relative = float(np.sqrt(squared / power)) if power > 0 else float(squared > 0)
    return OrderError(float((largest > tolerance).mean()), relative, float(largest.max()))
