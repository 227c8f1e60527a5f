"""Clouds of points that users bring: places, and normals and colours where the file has them."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from renderer.core.errors import AssetError, LimitError
from renderer.core.params import Model, param
from renderer.world.image import srgb_decode
from renderer.world.limits import DEFAULT_LIMITS, Limits, check_file
from renderer.world.mesh import Up
from renderer.world.points_files import Columns, columns_of

FORMATS = "PLY without faces, LAS, LAZ, .npz with position, or .npy with 3, 6 or 9 columns"

FEWEST = 16
"""Points below which a file is no cloud: a normal is found from that many neighbours."""


class PointsReading(Model):
    """What a file of points leaves unsaid: which axis is up, and how long its unit is."""

    up: Up = param(
        "file", label="Up axis", cost="bake", help="Which axis of the file is up; file means z, as surveys have it."
    )
    unit_length: float = param(
        1.0, label="Length of a unit", help="Metres of one unit of the file.", unit="m", cost="bake", ge=1e-4, le=1e4
    )


@dataclass(frozen=True)
class Points:
    """A cloud.

    Attributes:
        position: (N, 3) float64 [m], z up.
        normal: (N, 3) float64 unit, or None where the file has none.
        colour: (N, 3) float64 linear reflectance, or None.
        notes: what was assumed or left out, in words.
    """

    position: np.ndarray
    normal: np.ndarray | None = None
    colour: np.ndarray | None = None
    notes: tuple[str, ...] = field(default_factory=tuple)


def load_points(path: Path, limits: Limits = DEFAULT_LIMITS, reading: PointsReading | None = None) -> Points:
    """Read a cloud from PLY, LAS, LAZ, .npz or .npy; the content decides.

    Colours of bytes and of 16 bits are taken as sRGB, real numbers as linear reflectance.

    Raises:
        AssetError: naming `file`, `position`, `normal` or `colour`, in words.
        LimitError: too many bytes or points.
    """
    reading = reading or PointsReading()
    check_file(path, limits)
    found = columns_of(path, limits)
    position = np.asarray(found.position, np.float64)
    if position.ndim != 2 or position.shape[1] != 3:
        raise AssetError("position", f"has shape {position.shape}", "(N, 3)")
    _count(len(position), limits)
    if not np.isfinite(position).all():
        lost = int((~np.isfinite(position).all(axis=1)).sum())
        raise AssetError("position", f"holds {lost:,} places that are no numbers", "finite numbers")
    turn = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]) if reading.up == "y" else np.eye(3)
    position = position @ (turn * reading.unit_length).T
    extent = np.ptp(position, axis=0)
    if not extent.max() > 0:
        raise AssetError("position", "is one place for all points", "an extent")
    normal, said = _normals(found, len(position))
    colour = _colours(found, len(position))
    return Points(position, None if normal is None else normal @ turn.T, colour, (*found.notes, *said))


def _count(count: int, limits: Limits) -> None:
    if count > limits.points:
        raise LimitError("position", f"has {count:,} points", f"at most {limits.points:,}")
    if count < FEWEST:
        raise AssetError("position", f"has {count:,} points", f"at least {FEWEST}")


def _normals(found: Columns, count: int) -> tuple[np.ndarray | None, tuple[str, ...]]:
    """Unit normals; none where some have no direction, which a note says."""
    if found.normal is None:
        return None, ()
    if found.normal.shape != (count, 3):
        raise AssetError("normal", f"has shape {found.normal.shape}", f"({count}, 3)")
    normal = np.asarray(found.normal, np.float64)
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    if not np.isfinite(length).all() or not (length > 0).all():
        return None, ("normals without direction were left out",)
    return normal / length, ()


def _colours(found: Columns, count: int) -> np.ndarray | None:
    if found.colour is None:
        return None
    if found.colour.shape != (count, 3):
        raise AssetError("colour", f"has shape {found.colour.shape}", f"({count}, 3)")
    if found.colour.dtype.kind in "iu":
        most = float(np.iinfo(found.colour.dtype).max)
        return np.asarray(srgb_decode(np.clip(found.colour.astype(np.float64) / most, 0, 1)))
    colour = np.asarray(found.colour, np.float64)
    if not np.isfinite(colour).all() or colour.min() < 0 or colour.max() > 1:
        raise AssetError("colour", "holds values that are no reflectances", "0 to 1, or whole numbers of 8 or 16 bits")
    return colour
