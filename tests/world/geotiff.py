"""A GeoTIFF with the tags as given, so that the reader is not judged by our writer."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import tifffile

HEIGHTS = (np.arange(30, dtype=np.float32).reshape(5, 6) * 10).astype(np.float32)
UTM = (1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 2, 3072, 0, 1, 32633)
DEGREES = (1, 1, 0, 3, 1024, 0, 1, 2, 1025, 0, 1, 1, 2048, 0, 1, 4326)


def tiff(
    folder: Path,
    values: np.ndarray = HEIGHTS,
    *,
    keys: tuple[int, ...] | None = UTM,
    scale: tuple[float, ...] | None = (20, 25, 0),
    tie: tuple[float, ...] | None = (0, 0, 0, 500_000, 5_000_000, 0),
    more: tuple = (),
    **options,
) -> Path:
    """A GeoTIFF with the tags as given, so that the reader is not judged by our writer."""
    tags = [(34735, "H", len(keys), keys, True)] if keys else []
    tags += [(33550, "d", 3, scale, True)] if scale else []
    tags += [(33922, "d", 6, tie, True)] if tie else []
    path = folder / "terrain.tif"
    tifffile.imwrite(path, values, extratags=[*tags, *more], metadata=None, **options)
    return path
