"""Volumes as a pile of pictures: a .zip of PNG files of one size, the first by name the lowest layer."""

from __future__ import annotations

import re
import zipfile
import zlib
from pathlib import Path

import numpy as np

from renderer.core.errors import AssetError, LimitError
from renderer.world.arrays import archive_names
from renderer.world.image_files import MAGIC, codes_of, straight_of
from renderer.world.limits import Limits


def stack_names(path: Path) -> list[str]:
    """Names of the pictures of an archive, lowest first (slice2 before slice10); none where it holds anything else.

    Raises:
        AssetError: not a zip archive, or one with more members than a stack of ours can have.
    """
    names = [name for name in archive_names(path) if not name.endswith("/")]
    if not all(name.lower().endswith(".png") for name in names):
        return []
    return sorted(names, key=lambda name: [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", name)])


def load_stack(path: Path, limits: Limits) -> tuple[np.ndarray, tuple[str, ...]]:
    """The layers as (Z, Y, X, 4) float32, linear straight colour and opacity, and notes in words.

    A picture's upper edge is north, its codes are sRGB. Where pictures have no alpha, opacity is their brightness.

    Raises:
        AssetError: a layer that is damaged, is no PNG or has another size than the first. LimitError: too many voxels.
    """
    names = stack_names(path)
    layers: list[np.ndarray] = []
    plain = False
    with zipfile.ZipFile(path) as archive:
        for name in names:
            codes = codes_of(_data(archive, name, limits), limits)
            voxels = codes.shape[0] * codes.shape[1] * len(names)
            if voxels > limits.voxels:
                raise LimitError("file", f"has {voxels:,} voxels", f"at most {limits.voxels:,}")
            plain = plain or codes.shape[2] in (1, 3)
            layer = straight_of(codes)[::-1]
            if codes.shape[2] in (1, 3):
                layer[..., 3] = (codes / np.iinfo(codes.dtype).max).mean(axis=2)[::-1]
            if layers and layer.shape != layers[0].shape:
                raise AssetError("file", f"has layers of different sizes: {name[:40]!r} is unlike others", "one size")
            layers.append(layer)
    notes: tuple[str, ...] = (f"{len(layers)} pictures as layers, {names[0][:40]!r} the lowest",)
    if plain:
        notes += ("pictures without alpha: their brightness was taken as opacity",)
    return np.stack(layers), notes


def _data(archive: zipfile.ZipFile, name: str, limits: Limits) -> bytes:
    """A member's bytes, no more than a file may have."""
    try:
        with archive.open(name) as stream:
            data = stream.read(limits.file_bytes + 1)
    except (zipfile.BadZipFile, zlib.error, EOFError, OSError, RuntimeError, NotImplementedError, KeyError) as failure:
        raise AssetError("file", f"is damaged or cut short in {name[:40]!r}") from failure
    if len(data) > limits.file_bytes:
        raise LimitError("file", f"has {name[:40]!r} of more than {limits.file_bytes:,} bytes", "a smaller picture")
    if not data.startswith(MAGIC[0][0]):
        raise AssetError("file", f"has {name[:40]!r}, which is no PNG picture", "PNG pictures alone")
    return data
