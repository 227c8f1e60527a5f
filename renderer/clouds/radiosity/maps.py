"""What a bounce technique is given, and what it gives back: maps on one square grid between ground and cloud base."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from renderer.clouds.radiosity.bases import CELL, GRID


@dataclass(frozen=True)
class BounceMaps:
    """First light on ground and cloud base, and how both answer it.

    Every map is (N, N) or (N, N, C), C colour bands: row 0 at the south, column 0 in the west, as textures lie.

    Attributes:
        cell: side of a cell, m.
        height: of the cloud base above the elevation 0, m.
        elevation: of the ground, m; (N, N).
        albedo: of the ground, diffuse; (N, N, C).
        reflectance: of the cloud base for diffuse light from below, 0 where there is no cloud; (N, N, C) or (N, N).
        ground: irradiance of the ground's own slope before any bounce: sun through the layer, sky, and what the layer
            lets through; W m-2, (N, N, C).
        cloud: irradiance of the base from below before any bounce: the sun under the layer; W m-2, (N, N, C).
        emitted: light that leaves the base downwards and is not in `ground` yet, W m-2, (N, N, C); none where left out.
        centre: of the square in the plane of the ground, m.
    """

    cell: float
    height: float
    elevation: np.ndarray
    albedo: np.ndarray
    reflectance: np.ndarray
    ground: np.ndarray
    cloud: np.ndarray
    emitted: np.ndarray | None = None
    centre: tuple[float, float] = (0.0, 0.0)

    @property
    def half(self) -> float:
        """Half of the square's side, m."""
        return self.cell * self.n / 2

    @property
    def n(self) -> int:
        """Cells along a side."""
        return len(self.elevation)

    @property
    def reflectances(self) -> np.ndarray:
        """Reflectance in every band, (N, N, C)."""
        found = np.asarray(self.reflectance)
        return np.broadcast_to(found[..., None] if found.ndim == 2 else found, self.albedo.shape)

    def leaving(self) -> tuple[np.ndarray, np.ndarray]:
        """Radiosity of ground and cloud base before any bounce, (N, N, C) each."""
        cloud = self.reflectances * self.cloud
        return self.albedo * self.ground, cloud if self.emitted is None else cloud + self.emitted


@dataclass(frozen=True)
class Bounced:
    """Irradiance that bounces add, W m-2, (N, N, C): on the ground's own slope, and on the cloud base from below."""

    ground: np.ndarray
    cloud: np.ndarray


def square_cells(wide: float) -> tuple[int, float]:
    """Cells along a side of the square on which bounces are computed, and a cell's side in metres.

    Args:
        wide: the square's reach, m: the height of the cloud base, or a multiple of it seen from far.
    """
    return GRID, CELL * wide


def uniform_gain(albedo: np.ndarray, reflectance: np.ndarray) -> np.ndarray:
    """Sum of all bounces between endless uniform planes: 1 / (1 - R rho) (formulas a7)."""
    return 1 / (1 - np.minimum(albedo * reflectance, 1 - 1e-6))
