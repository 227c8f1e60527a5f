"""Volumes of colour and opacity that users bring: read, checked, and turned into what the renderers need.

Index order is [z, y, x]: z upwards, y north, x east, each from low to high. Colours are linear.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from renderer.core.errors import AssetError, LimitError
from renderer.core.params import Model, Vector3, param
from renderer.world.arrays import npz_names, read_npz
from renderer.world.limits import DEFAULT_LIMITS, Limits, Unsaid, check_file
from renderer.world.volume_stack import load_stack, stack_names

Association = Literal["file", "straight", "associated"]

CLAMP = 2.0**-12
"""Least transmittance of a reference length: opacity 1 becomes an extinction of 8.3 per length instead of infinity."""


class VolumeReading(Model):
    """What a volume file may leave unsaid. A length of 0 means: as the file says."""

    alpha: Association = param(
        "file",
        label="Alpha",
        cost="bake",
        help="Whether colours were multiplied by opacity (associated) or not (straight).",
    )
    reference_length: float = param(
        0.0,
        label="Reference length",
        unit="m",
        cost="bake",
        ge=0,
        le=1e5,
        help="Length of path for which the opacities are meant; 0 takes the file's own.",
    )
    size: Vector3 = param(
        (0.0, 0.0, 0.0),
        label="Size",
        unit="m",
        cost="bake",
        help="Extent along x, y and z; 0 takes the file's own, or one reference length a voxel.",
    )


@dataclass(frozen=True)
class Volume:
    """A box of matter.

    Args:
        rgba: (Z, Y, X, 4) float32; linear colour times opacity (associated), and opacity in [0, 1].
        reference_length: metres of path for which the opacity is meant.
        size: extent along x, y, z, metres.
        notes: what was assumed while reading, in words.
        straight: (Z, Y, X, 3) float32, the colours of a file that did not multiply them by opacity: they are known
            where there is no matter, too. None where it did.
    """

    rgba: np.ndarray
    reference_length: float
    size: tuple[float, float, float]
    notes: tuple[str, ...] = ()
    straight: np.ndarray | None = None

    def extinction(self) -> np.ndarray:
        """Extinction per metre, (Z, Y, X) float32: -ln(1 - opacity) / reference length, opacity at most 1 - 2^-12."""
        transmittance = np.maximum(1 - self.rgba[..., 3].astype(np.float64), CLAMP)
        return (-np.log(transmittance) / self.reference_length).astype(np.float32)

    def colour(self) -> np.ndarray:
        """Straight linear colour, (Z, Y, X, 3) float32; where there is no matter, the file's own or black."""
        if self.straight is not None:
            return self.straight
        opacity = self.rgba[..., 3:]
        return np.divide(self.rgba[..., :3], opacity, out=np.zeros_like(self.rgba[..., :3]), where=opacity > 0)


def load_volume(path: Path, limits: Limits = DEFAULT_LIMITS, reading: VolumeReading | None = None) -> Volume:
    """Read a volume from an .npz with `rgba` [z, y, x, 4], or from a .zip of pictures (see `load_stack`).

    Integers are shares of their type's largest value, floats are taken as they are. The file may also hold `alpha`
    ("straight" or "associated"), `reference_length` (metres) and `size` (x, y, z, metres); `reading` overrides them.

    Args:
        path: the file.
        limits: bounds on its size.
        reading: what the file leaves unsaid.

    Raises:
        AssetError: naming `file`, `rgba`, `alpha`, `reference_length` or `size`, in words.
        LimitError: too many bytes or voxels.
    """
    reading = reading or VolumeReading()
    if check_file(path, limits)[:4] != b"PK\x03\x04":
        raise AssetError("file", "is no volume that can be read", ".npz with rgba [z, y, x, 4]")
    said: tuple[str, ...] = ()
    if stack_names(path):
        rgba, said = load_stack(path, limits)
        data = {"alpha": np.array("straight")}
    elif "rgba" in npz_names(path):
        data = read_npz(path, ("rgba", "alpha", "reference_length", "size"), limits.voxels * 4 * 8)
        rgba = _shares(data["rgba"], limits)
    else:
        raise AssetError("rgba", "is not among the arrays of the file", "rgba [z, y, x, 4], or a .zip of PNG pictures")
    associated, notes = _association(data, reading)
    notes = (*said, *notes)
    length = _length(data, reading)
    size = _size(data, reading, rgba.shape, length)
    if associated:
        bright = int((rgba[..., :3].max(axis=-1) > rgba[..., 3] + 1 / 255).sum())
        if bright:
            notes += (f"{bright:,} voxels have more colour than opacity: they shine, or their alpha is straight",)
        return Volume(rgba, length, size, notes)
    straight = rgba[..., :3].copy()
    rgba[..., :3] *= rgba[..., 3:]
    return Volume(rgba, length, size, notes, straight)


def _shares(rgba: np.ndarray, limits: Limits) -> np.ndarray:
    """The voxels as float32, their shape and values checked."""
    if rgba.ndim != 4 or rgba.shape[-1] != 4 or min(rgba.shape) < 1:
        raise AssetError("rgba", f"has shape {rgba.shape}", "[z, y, x, 4], at least one voxel")
    voxels = math.prod(rgba.shape[:3])
    if voxels > limits.voxels:
        raise LimitError("rgba", f"has {voxels:,} voxels", f"at most {limits.voxels:,}")
    if rgba.dtype.kind == "u" and rgba.dtype.itemsize <= 2:
        return (rgba / np.float32(np.iinfo(rgba.dtype).max)).astype(np.float32)
    if rgba.dtype.kind != "f":
        raise AssetError("rgba", f"is of type {rgba.dtype}", "uint8, uint16 or floats")
    if not np.isfinite(rgba).all():
        raise AssetError(
            "rgba", f"holds {int((~np.isfinite(rgba)).sum()):,} values that are no numbers", "finite numbers"
        )
    if rgba.min() < 0 or rgba[..., 3].max() > 1 or rgba[..., :3].max() > MOST:
        raise AssetError(
            "rgba",
            f"has colours from {rgba[..., :3].min():g} to {rgba[..., :3].max():g} and opacities from "
            f"{rgba[..., 3].min():g} to {rgba[..., 3].max():g}",
            f"colours in [0, {MOST:g}], opacities in [0, 1]",
        )
    return rgba.astype(np.float32)


MOST = 65_504.0
"""Largest finite half float: brighter voxels would overflow in the textures of renderers."""


def _association(data: dict[str, np.ndarray], reading: VolumeReading) -> tuple[bool, tuple[str, ...]]:
    """Whether colours are associated with opacity, and what was assumed."""
    if reading.alpha != "file":
        return reading.alpha == "associated", ()
    if "alpha" not in data:
        return False, ("alpha was taken as straight, since neither the file nor the reader says",)
    word = str(data["alpha"].item()) if data["alpha"].dtype.kind == "U" and data["alpha"].size == 1 else ""
    if word not in ("straight", "associated"):
        raise AssetError("alpha", "is not one of the two words in the file", "straight or associated")
    return word == "associated", ()


def _length(data: dict[str, np.ndarray], reading: VolumeReading) -> float:
    """The reference length, metres."""
    if reading.reference_length > 0:
        return reading.reference_length
    if "reference_length" not in data:
        raise Unsaid(
            "reference_length", "is neither in the file nor said: an opacity belongs to a length of path", "metres"
        )
    return _positive(data["reference_length"], "reference_length", 1)[0]


def _size(
    data: dict[str, np.ndarray], reading: VolumeReading, shape: tuple[int, ...], length: float
) -> tuple[float, float, float]:
    """Extent along x, y and z, metres."""
    if reading.size != (0.0, 0.0, 0.0):
        x, y, z = _positive(np.array(reading.size), "size", 3)
    elif "size" in data:
        x, y, z = _positive(data["size"], "size", 3)
    else:
        x, y, z = shape[2] * length, shape[1] * length, shape[0] * length
    return x, y, z


def _positive(array: np.ndarray, name: str, count: int) -> tuple[float, ...]:
    if array.dtype.kind not in "iuf" or array.size != count:
        raise AssetError(
            name, f"has shape {array.shape} and type {array.dtype}", f"{count} numbers" if count > 1 else "one number"
        )
    values = tuple(float(value) for value in array.ravel())
    if not all(0 < value <= 1e6 for value in values):
        raise AssetError(name, "is " + ", ".join(f"{value:g}" for value in values) + " m", "more than 0, at most 1e6 m")
    return values


def save_volume(path: Path, volume: Volume) -> None:
    """Write a volume as .npz with everything that `load_volume` needs."""
    with path.open("wb") as stream:
        np.savez(
            stream,
            rgba=volume.rgba,
            alpha=np.array("associated"),
            size=np.array(volume.size),
            reference_length=np.array(volume.reference_length),
        )
