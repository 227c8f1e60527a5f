"""How far a picture is from its reference: relative RMSE in linear radiance, FLIP as displayed, and an error map."""

from __future__ import annotations

import os
from dataclasses import dataclass

# before its library is loaded: threads that spin while others work take six times what a small picture costs
os.environ.setdefault("OMP_WAIT_POLICY", "passive")

import flip_evaluator
import matplotlib
import numpy as np
from numpy.typing import NDArray

from renderer.core.errors import InputError

PIXELS_PER_DEGREE = 67.0
"""Viewing distance of FLIP's own default: 0.7 m from a 0.7 m wide, 3840 pixel display (Andersson et al. 2020)."""

LEGEND_STEPS = 5
"""Values named on the error map's colour scale, ends included."""

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Flip:
    """Perceived difference of two displayed pictures, 0 (none) to 1.

    Attributes:
        mean, p95: mean and 95th percentile over the pixels.
        map: the difference of each pixel, (H, W) float32, row 0 at the top.
    """

    mean: float
    p95: float
    map: NDArray[np.float32]


@dataclass(frozen=True)
class ErrorMap:
    """A false-colour picture of the error of each pixel.

    Attributes:
        rgb8: (H, W, 3) uint8, as displayed.
        legend: (value, (r, g, b) 0..255) from the bottom of the scale to its top, values in units of the reference's
            mean.
        top: value at which the scale saturates.
        saturated: share of pixels above `top`.
    """

    rgb8: NDArray[np.uint8]
    legend: tuple[tuple[float, tuple[int, int, int]], ...]
    top: float
    saturated: float


def _colours(image: NDArray[np.floating], reference: NDArray[np.floating]) -> tuple[Floats, Floats]:
    """Both pictures as float64 RGB; alpha, where there is one, is coverage and no part of the error."""
    if image.shape != reference.shape or image.ndim != 3 or image.shape[2] not in (3, 4):
        raise InputError("image", f"has shape {image.shape}, its reference {reference.shape}", "equal (H, W, 3 or 4)")
    pair = image[..., :3].astype(np.float64), reference[..., :3].astype(np.float64)
    if not (np.isfinite(pair[0]).all() and np.isfinite(pair[1]).all()):
        raise InputError("image", "holds values that are not finite")
    return pair


def _mean(reference: Floats) -> float:
    mean = float(reference.mean())
    if mean <= 0:
        raise InputError("reference", "is black: an error relative to its mean has no meaning")
    return mean


def relative_rmse(image: NDArray[np.floating], reference: NDArray[np.floating]) -> float:
    """Root mean square error over pixels and channels, divided by the reference's mean.

    Args:
        image, reference: (H, W, 3 or 4) linear radiance, W m-2 sr-1.

    Returns:
        The error, a ratio; symmetric in sign, not in its arguments.

    Raises:
        InputError: shapes differ, values are not finite, or the reference is black.
    """
    picture, truth = _colours(image, reference)
    return float(np.sqrt(np.mean((picture - truth) ** 2))) / _mean(truth)


def stained(image: NDArray[np.floating], reference: NDArray[np.floating], off: float = 0.5) -> float:
    """Share of the pixels, by their mean over the channels, that are off by more than `off` of the reference's mean.

    Args:
        image, reference: (H, W, 3 or 4) linear radiance, W m-2 sr-1.

    Raises:
        InputError: as `relative_rmse`.
    """
    picture, exact = _colours(image, reference)
    return float((np.abs(picture - exact).mean(axis=-1) > off * _mean(exact)).mean())


def best_gain(image: NDArray[np.floating], reference: NDArray[np.floating]) -> float:
    """The factor on `image` that brings it closest to `reference` in the least-squares sense (1 for a black image).

    Args:
        image, reference: (H, W, 3 or 4) linear radiance.
    """
    picture, truth = _colours(image, reference)
    energy = float(np.sum(picture * picture))
    return float(np.sum(picture * truth)) / energy if energy > 0 else 1.0


def flip(image: NDArray[np.uint8], reference: NDArray[np.uint8]) -> Flip:
    """FLIP of two displayed pictures (Andersson et al. 2020), by NVIDIA's `flip-evaluator`.

    Args:
        image, reference: (H, W, 3) uint8, sRGB as displayed, row 0 at the top.

    Raises:
        InputError: shapes differ or are not (H, W, 3), or a picture is not uint8.
    """
    if image.shape != reference.shape or image.ndim != 3 or image.shape[2] != 3:
        raise InputError("image", f"has shape {image.shape}, its reference {reference.shape}", "the same (H, W, 3)")
    if image.dtype != np.uint8 or reference.dtype != np.uint8:
        raise InputError("image", "FLIP compares displayed pictures", "uint8")
    found, _, _ = flip_evaluator.evaluate(
        reference.astype(np.float32) / np.float32(255),
        image.astype(np.float32) / np.float32(255),
        "LDR",
        inputsRGB=True,
        applyMagma=False,
        computeMeanError=False,
        parameters={"ppd": PIXELS_PER_DEGREE},
    )
    errors = np.asarray(found, np.float32).reshape(image.shape[:2])
    return Flip(float(errors.mean(dtype=np.float64)), float(np.percentile(errors, 95)), errors)


def error_map(image: NDArray[np.floating], reference: NDArray[np.floating], top: float | None = None) -> ErrorMap:
    """Error of each pixel, root mean square over its channels, divided by the reference's mean, in false colour.

    The mean square of the mapped values is the square of `relative_rmse`: map and number speak of the same thing.

    Args:
        image, reference: (H, W, 3 or 4) linear radiance.
        top: value at which the scale saturates, in units of the reference's mean; the 99th percentile when not given.

    Raises:
        InputError: as `relative_rmse`, or a scale that is not positive.
    """
    picture, truth = _colours(image, reference)
    values = np.sqrt(np.mean((picture - truth) ** 2, axis=2)) / _mean(truth)
    if top is None:
        # A picture equal to its reference still needs a scale: one thousandth of the mean is below what 8 bits show.
        top = max(float(np.percentile(values, 99)), 1e-3)
    if not top > 0:
        raise InputError("top", "the scale's top must be positive")
    scale = matplotlib.colormaps["magma"]
    coloured = scale(np.clip(values / top, 0, 1), bytes=True)[..., :3]
    steps = np.linspace(0, 1, LEGEND_STEPS)
    legend = tuple(
        (float(step * top), (int(c[0]), int(c[1]), int(c[2])))
        for step, c in zip(steps, scale(steps, bytes=True), strict=True)
    )
    return ErrorMap(np.ascontiguousarray(coloured, np.uint8), legend, top, float(np.mean(values > top)))
