"""What every source of 3D texture has: its resolution, and helpers to turn distances into matter."""

from __future__ import annotations

from abc import abstractmethod
from typing import Any, ClassVar

import numpy as np

from renderer.core.params import Model, param
from renderer.shells.texture.block import Matter

Rgb = tuple[float, float, float]


class Source(Model):
    """Where a 3D texture comes from."""

    seconds: ClassVar[float] = 1.0
    """What its block takes to make, to announce it."""

    @abstractmethod
    def matter(self) -> Matter:
        """Make the block.

        Raises:
            InputError: naming a field of this source.
        """


class Procedure(Source):
    """A source that is computed: of a resolution, meant for one voxel of the shell's height."""

    across: int = param(
        128, label="Voxels across", help="Along each side of the repeated square.", unit="voxel", cost="bake",
        ge=8, le=512, source="Dufort 2005, table 6.1",
    )
    layers: int = param(
        32, label="Voxels high", help="From the base surface to the shell's top.", unit="voxel", cost="bake",
        ge=4, le=64, source="Dufort 2005, table 6.1",
    )
    reference_length: float = param(
        0.0, label="Reference length", unit="m", cost="host", ge=0, le=100,
        help="Path for which the opacities are meant; 0 takes one voxel of the shell's height.",
    )

    @property
    def shape(self) -> tuple[int, int, int]:
        """Of the arrays, [k, j, i]."""
        return self.layers, self.across, self.across

    @property
    def side(self) -> float:
        """Of the square where the height is 1."""
        return self.across / self.layers

    def centres(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """x (1, 1, I), y (1, J, 1) and z (K, 1, 1) of the voxels' centres, where the height is 1, float32."""
        step = 1.0 / self.layers
        along = ((np.arange(self.across) + 0.5) * step).astype(np.float32)
        up = ((np.arange(self.layers) + 0.5) * step).astype(np.float32)
        return along[None, None, :], along[None, :, None], up[:, None, None]

    def points(self) -> np.ndarray:
        """The voxels' centres where the height is 1, (K J I, 3) float64."""
        x, y, z = self.centres()
        grid = np.broadcast_arrays(x, y, z)
        return np.stack([part.ravel() for part in grid], axis=1).astype(np.float64)

    def covered(self, distance: np.ndarray) -> np.ndarray:
        """Share of a voxel inside a surface at a signed distance (negative inside; the height is 1)."""
        return np.clip(0.5 - distance * self.layers, 0.0, 1.0).astype(np.float32)


def generator(seed: int) -> np.random.Generator:
    """Chance that is the same everywhere for one seed."""
    return np.random.Generator(np.random.PCG64(seed))


def wrapped(offset: np.ndarray, side: float) -> np.ndarray:
    """The shortest of an offset's images under repetition by `side`."""
    shortest: np.ndarray = offset - side * np.round(offset / side)
    return shortest


def unit(vectors: np.ndarray) -> np.ndarray:
    """Vectors (..., 3) of length 1; 0 where they have none; float32."""
    length = np.sqrt((vectors * vectors).sum(axis=-1, keepdims=True))
    return np.divide(vectors, length, out=np.zeros(vectors.shape, np.float32), where=length > 1e-12)


def slope_of(field: np.ndarray) -> np.ndarray:
    """Gradient (K, J, I, 3) of a field of cubical voxels, per voxel: central, periodic in u and v, one-sided at the
    ends of w."""
    found = np.empty((*field.shape, 3), np.float32)
    found[..., 0] = (np.roll(field, -1, axis=2) - np.roll(field, 1, axis=2)) / 2
    found[..., 1] = (np.roll(field, -1, axis=1) - np.roll(field, 1, axis=1)) / 2
    found[..., 2] = np.gradient(field, axis=0)
    return found


def mixed(*parts: tuple[np.ndarray, Any]) -> np.ndarray:
    """Colour and opacity (K, J, I, 4) float32 of matters that share voxels.

    Args:
        parts: opacity (K, J, I), as far as each fills a voxel, and colour, one or (K, J, I, 3). Where there is no
            matter the first one's colour stands, so that nothing dark bleeds in from empty voxels.
    """
    opacity = sum(part for part, _ in parts)
    shape = np.shape(opacity)
    first = np.broadcast_to(np.asarray(parts[0][1], np.float32), (*shape, 3))
    sums = sum(part[..., None] * np.asarray(colour, np.float32) for part, colour in parts)
    there = np.broadcast_to(np.asarray(opacity)[..., None] > 0, (*shape, 3))
    colour = np.divide(sums, np.asarray(opacity)[..., None], out=first.copy(), where=there)
    return np.concatenate([colour, np.asarray(opacity, np.float32)[..., None]], axis=-1)


def with_glow(normal: np.ndarray, glow: np.ndarray | float = 0.0) -> np.ndarray:
    """Normals (K, J, I, 3) and the share of glow as one array of four."""
    found = np.empty((*normal.shape[:-1], 4), np.float32)
    found[..., :3], found[..., 3] = normal, glow
    return found
