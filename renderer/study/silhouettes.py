"""How far a drawn silhouette lies from the true one, and which pixels are away from it."""

from __future__ import annotations

from dataclasses import dataclass

import contourpy
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt
from scipy.spatial import cKDTree

from renderer.core.errors import InputError

SPACING = 0.25
"""Pixels between the points by which an outline is known."""


@dataclass(frozen=True)
class Apart:
    """Distances between two outlines, from the points of each to the other.

    Attributes:
        median, p95, worst: in pixels.
        length: of the true outline, pixels.
    """

    median: float
    p95: float
    worst: float
    length: float


def outline(alpha: NDArray[np.floating], level: float = 0.5) -> NDArray[np.float64]:
    """Points (N, 2) on the curve where the opacity passes a level, linear between pixels' centres; `SPACING` apart.

    Args:
        alpha: (H, W) 0..1. Where the subject is cut by the picture's edge, there is no outline.

    Returns:
        Column and row in pixels, centres at whole numbers.

    Raises:
        InputError: alpha is no picture.
    """
    if alpha.ndim != 2 or min(alpha.shape) < 2:
        raise InputError("alpha", f"has shape {alpha.shape}", "(H, W), both at least 2")
    lines = contourpy.contour_generator(z=np.asarray(alpha, np.float64)).lines(level)
    found = [_even(np.asarray(line)) for line in lines]
    return np.concatenate(found) if found else np.zeros((0, 2))


def _even(line: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points at equal steps along a line, as if in the middle of as many equal parts."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    count = max(1, round(float(along[-1]) / SPACING))
    at = (np.arange(count) + 0.5) / count * along[-1]
    return np.stack([np.interp(at, along, line[:, axis]) for axis in (0, 1)], axis=1)


def apart(picture: NDArray[np.floating], reference: NDArray[np.floating]) -> Apart:
    """How far a picture's silhouette is from the true one, both ways: what is drawn beyond, and what is missing.

    Args:
        picture, reference: opacity (H, W) 0..1.

    Returns:
        Distances; the picture's diagonal where nothing at all is drawn.

    Raises:
        InputError: shapes differ, or the reference has no silhouette.
    """
    if picture.shape != reference.shape:
        raise InputError("picture", f"has shape {picture.shape}", str(reference.shape))
    drawn, true = outline(picture), outline(reference)
    if not len(true):
        raise InputError("reference", "has no silhouette")
    if not len(drawn):
        far = float(np.hypot(*reference.shape))
        return Apart(far, far, far, SPACING * len(true))
    both = np.concatenate([cKDTree(true).query(drawn)[0], cKDTree(drawn).query(true)[0]])
    return Apart(float(np.median(both)), float(np.percentile(both, 95)), float(both.max()), SPACING * len(true))


def away(alpha: NDArray[np.floating], pixels: float) -> NDArray[np.bool_]:
    """Pixels (H, W) of the subject whose centres are more than so many pixels from any that it does not fill.

    Args:
        alpha: opacity of the reference (H, W); beyond the picture's edge the subject is taken to go on.
    """
    inside: NDArray[np.bool_] = distance_transform_edt(np.asarray(alpha) >= 1 - 1e-6) > pixels
    if (np.asarray(alpha) >= 1 - 1e-6).all():
        inside = np.ones(np.shape(alpha), np.bool_)
    return inside
