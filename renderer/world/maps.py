"""Maps of one quantity over a square of land: what a user paints or a survey gives, as a plain grid of numbers.

Row 0 is the northern edge. A map has no size of its own: whoever uses it says what it covers.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy import ndimage

from renderer.core.errors import AssetError, LimitError
from renderer.world.arrays import npz_names, read_npz
from renderer.world.image_files import load_codes
from renderer.world.limits import DEFAULT_LIMITS, Limits, check_file
from renderer.world.terrain_files import read_raster, terrain_format
from renderer.world.terrain_grid import TerrainReading

QUANTITIES = ("density", "species", "thickness")
"""Names of the arrays that an .npz may hold as a map."""


def load_map(path: Path, quantity: str, limits: Limits = DEFAULT_LIMITS) -> tuple[np.ndarray, float]:
    """A map from a picture (grey, or its first channel), a GeoTIFF, or an .npz with an array of that name.

    Args:
        path: the file. quantity: name of the array in an .npz. limits: bounds on its size.

    Returns:
        Values (rows, columns) float64 as the file has them, and the largest that its type can hold: 255 or 65535 of
        whole numbers in a picture or an array, 1 of real ones and of a GeoTIFF.

    Raises:
        AssetError, LimitError: naming `file` or the array, in words.
    """
    kind = terrain_format(check_file(path, limits))
    if kind == "npz":
        values = _from_npz(path, quantity, limits)
    elif kind == "tiff":
        # Cells and heights are a terrain's; a map only needs its numbers.
        values = read_raster(path, limits, TerrainReading(cell_size=(1.0, 1.0))).elevation
    else:
        values = load_codes(path, limits)[..., 0]
    if min(values.shape) < 1:
        raise AssetError(quantity, f"has {values.shape[0]} x {values.shape[1]} values", "at least one")
    full = float(np.iinfo(values.dtype).max) if values.dtype.kind in "iu" else 1.0
    numbers = values.astype(np.float64)
    if not np.isfinite(numbers).all():
        raise AssetError(quantity, "holds values that are not finite numbers")
    return numbers, full


def _from_npz(path: Path, quantity: str, limits: Limits) -> np.ndarray:
    names = npz_names(path)
    if quantity not in names:
        held = ", ".join(name[:40] for name in names[:5]) or "none"
        raise AssetError(quantity, f"is not among the arrays of the file: {held}", f"{quantity} (2D, row 0 the north)")
    values = read_npz(path, (quantity,), limits.cells * 8)[quantity]
    if values.dtype.kind not in "biuf" or values.ndim != 2:
        raise AssetError(quantity, f"is {values.dtype} of shape {values.shape}", "numbers, rows x columns")
    if values.size > limits.cells:
        raise LimitError(quantity, f"has {values.size:,} values", f"at most {limits.cells:,}")
    return values.astype(np.float64) if values.dtype.kind == "b" else values


def spread(values: np.ndarray, count: int) -> np.ndarray:
    """A map stretched over a square of `count` x `count` places, bilinear between the centres of its pixels.

    Where the map is finer, it is first smoothed by a Gaussian of half the excess, so that no detail aliases.
    """
    ratio = [length / count for length in values.shape]
    smooth = ndimage.gaussian_filter(values, [max(0.0, (r - 1) / 2) for r in ratio], mode="nearest")
    at = np.meshgrid(*((np.arange(count) + 0.5) * r - 0.5 for r in ratio), indexing="ij")
    return np.asarray(ndimage.map_coordinates(smooth, at, order=1, mode="nearest"))
