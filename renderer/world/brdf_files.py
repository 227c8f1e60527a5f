"""Reflectances in: files of the MERL database, and tables of one's own as an .npz, checked before they are believed."""

from __future__ import annotations

import math
import struct
from pathlib import Path

import numpy as np

from renderer.core.errors import AssetError, LimitError
from renderer.world.arrays import npz_names, read_npz
from renderer.world.brdf import BrdfTable, made_one_at_the_pole
from renderer.world.limits import DEFAULT_LIMITS, Limits, check_file

MERL_SHAPE = (90, 90, 180)
"""Cells of a MERL file by half angle, difference angle and difference azimuth (half a turn)."""

MERL_SCALE = (1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0)
"""What a MERL file's red, green and blue are multiplied by (Matusik et al. 2003, reader of the database)."""

MERL_BYTES = 12 + 3 * math.prod(MERL_SHAPE) * 8

MERL_HEAD = struct.pack("<3i", *MERL_SHAPE)
"""First bytes of a MERL file."""

ARRAYS = ("brdf", "theta_o", "phi_o", "theta_l", "phi_l", "delta_phi")
"""Arrays that an .npz may hold; angles in degrees."""

SAID = (
    "brdf [theta_o, phi_o, theta_l, phi_l, rgb] with the node angles theta_o, phi_o, theta_l, phi_l in degrees, "
    "or brdf [theta_o, theta_l, delta_phi, rgb] with theta_o, theta_l, delta_phi"
)

NEAREST = {"theta": 0.1, "phi": 0.4}
"""Degrees that nodes must be apart."""

MOST = 1e6
"""Greatest reflectance that is believed, sr-1."""


def load_brdf(path: Path, limits: Limits = DEFAULT_LIMITS) -> BrdfTable:
    """A table from a MERL file or an .npz.

    Args:
        path: the file. limits: bounds of its size in bytes and values.

    Raises:
        AssetError: naming `file` or the array that is damaged, missing, or of another shape.
        LimitError: one that is larger, or claims to be, than the limits allow.
    """
    head = check_file(path, limits)
    if head.startswith(b"PK"):
        return _npz(path, limits)
    if is_merl(head):
        return _merl(path, limits)
    raise AssetError("file", "is no reflectance of a known format", f"a MERL file, or an .npz: {SAID}")


def is_merl(head: bytes) -> bool:
    """Whether a file starts as those of the MERL database do."""
    return head.startswith(MERL_HEAD)


def _merl(path: Path, limits: Limits) -> BrdfTable:
    """A table over half vectors: nodes are the middles of the file's cells."""
    size = path.stat().st_size
    if size != MERL_BYTES:
        raise AssetError("file", f"has {size:,} bytes", f"{MERL_BYTES:,} in a MERL file of 90 x 90 x 180 values")
    if math.prod(MERL_SHAPE) > limits.brdf_values:
        raise LimitError("file", f"has {math.prod(MERL_SHAPE):,} directions", f"at most {limits.brdf_values:,}")
    stored = np.fromfile(path, "<f8", offset=12).reshape(3, *MERL_SHAPE)
    if not np.isfinite(stored).all():
        raise AssetError("file", "holds values that are not finite numbers")
    values = np.moveaxis(stored, 0, -1) * MERL_SCALE
    valid = np.asarray((stored >= 0).all(axis=0))
    if not valid.any():
        raise AssetError("file", "holds no valid value: all are negative")
    if values.max() > MOST:
        raise AssetError("file", f"holds a reflectance of {values.max():.3g} sr-1", f"at most {MOST:g}")
    halves, angles, azimuths = MERL_SHAPE
    nodes = (
        (np.arange(halves) + 0.5) / halves,
        np.zeros(1),
        (np.arange(angles) + 0.5) * (0.5 * math.pi / angles),
        (np.arange(azimuths) + 0.5) * (math.pi / azimuths),
    )
    share = float(1 - valid.mean())
    notes = (f"MERL file; {share:.1%} of its cells are marked invalid and take the nearest valid one's value",)
    return BrdfTable("half", nodes, _filled(values, valid)[:, None], notes)


def _filled(values: np.ndarray, valid: np.ndarray) -> np.ndarray:
    """Values with invalid cells (light or view below the horizon) taken from the nearest valid angle to the light.

    Without that, cells at the edge would be mixed with nothing and darken.
    """
    count = valid.shape[1]
    number = np.where(valid, np.arange(count)[None, :, None], -1)
    before = np.maximum.accumulate(number, axis=1)
    after = np.where(valid, np.arange(count)[None, :, None], count)
    after = np.minimum.accumulate(after[:, ::-1], axis=1)[:, ::-1]
    chosen = np.where(before >= 0, before, np.where(after < count, after, 0))
    found = np.take_along_axis(values, chosen[..., None], axis=1)
    return np.asarray(np.maximum(found, 0.0))


def _npz(path: Path, limits: Limits) -> BrdfTable:
    names = npz_names(path)
    if "brdf" not in names:
        held = ", ".join(name[:40] for name in names[:5]) or "none"
        raise AssetError("brdf", f"is not among the arrays of the file: {held}", SAID)
    arrays = read_npz(path, ARRAYS, limits.brdf_values * 24)
    values = arrays["brdf"]
    if values.dtype.kind not in "iuf" or values.ndim not in (4, 5) or values.shape[-1] != 3 or 0 in values.shape:
        raise AssetError("brdf", f"is {values.dtype} of shape {values.shape}", SAID)
    if values.size // 3 > limits.brdf_values:
        raise LimitError("brdf", f"has {values.size // 3:,} pairs of directions", f"at most {limits.brdf_values:,}")
    values = values.astype(np.float64)
    if not np.isfinite(values).all() or values.min() < 0 or values.max() > MOST:
        raise AssetError("brdf", "holds values that are no reflectance", f"numbers from 0 to {MOST:g} sr-1")
    own = ("theta_o", "phi_o", "theta_l", "phi_l") if values.ndim == 5 else ("theta_o", "theta_l", "delta_phi")
    axes = [_nodes(arrays, name, count) for name, count in zip(own, values.shape)]
    notes: tuple[str, ...] = ()
    for axis, name in enumerate(own):
        if not name.startswith("theta"):
            axes[axis], values, words = _once_round(name, axes[axis], values, axis)
            notes += words
    if values.ndim == 5:
        table = BrdfTable("angles", (axes[0], axes[1], axes[2], axes[3]), values, notes)
    else:
        table = BrdfTable("difference", (axes[0], np.zeros(1), axes[1], axes[2]), values[:, None], notes)
    made = made_one_at_the_pole(table)
    changed = float(np.abs(made.values - table.values).max())
    if changed > 1e-9:
        said = f"at theta = 0, values of several azimuths were put together (they differed by up to {changed:.3g} sr-1)"
        return BrdfTable(made.coordinates, made.nodes, made.values, (*made.notes, said))
    return made


def _nodes(arrays: dict[str, np.ndarray], name: str, count: int) -> np.ndarray:
    """Nodes of an axis in radians, checked."""
    if name not in arrays:
        raise AssetError(name, "is missing from the file", SAID)
    nodes = arrays[name]
    if nodes.dtype.kind not in "iuf" or nodes.shape != (count,):
        raise AssetError(name, f"is {nodes.dtype} of shape {nodes.shape}", f"{count} angles, as brdf has there")
    nodes = nodes.astype(np.float64)
    polar = name.startswith("theta")
    low, high = (0.0, 90.0) if polar else (-360.0, 360.0)
    if not np.isfinite(nodes).all() or nodes.min() < low or nodes.max() > high:
        raise AssetError(name, "holds angles out of range", f"{low:g} to {high:g} degrees")
    gap = NEAREST["theta" if polar else "phi"]
    if (np.diff(nodes) < gap).any():
        raise AssetError(name, "does not ascend", f"each angle at least {gap:g} degrees above the one before")
    if not polar and nodes[-1] - nodes[0] > 360.0 + gap / 2:
        raise AssetError(name, "goes round more than once", "at most 360 degrees from first to last")
    return np.radians(nodes)


def _once_round(
    name: str, nodes: np.ndarray, values: np.ndarray, axis: int
) -> tuple[np.ndarray, np.ndarray, tuple[str, ...]]:
    """Azimuths and values round the whole turn, each once.

    Differences of azimuth from 0 to 180 degrees stand for both sides; a last node a turn from the first repeats it.
    """
    both = name == "delta_phi" and abs(nodes[0]) < 1e-9 and abs(nodes[-1] - math.pi) < 1e-9 and len(nodes) > 1
    if both:
        inner = np.arange(len(nodes) - 2, 0, -1)
        nodes = np.concatenate([nodes, 2 * math.pi - nodes[inner]])
        values = np.concatenate([values, np.take(values, inner, axis)], axis)
        return nodes, values, ("differences of azimuth from 0 to 180 degrees stand for both sides",)
    if nodes[-1] - nodes[0] > 2 * math.pi - math.radians(NEAREST["phi"]):
        values = np.take(values, np.arange(len(nodes) - 1), axis)
        return nodes[:-1], values, (f"the last of {name} is the first again and is left out",)
    return nodes, values, ()
