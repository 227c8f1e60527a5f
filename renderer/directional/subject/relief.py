"""A block of land: the elevation model that the other scenes stand on, or the user's."""

from __future__ import annotations

from typing import Literal

import numpy as np

from renderer.core.cache import AssetStore
from renderer.core.errors import InputError
from renderer.core.params import Model, param
from renderer.directional.subject.grids import face_middles, grid_faces, joined
from renderer.directional.subject.solid import Solid
from renderer.world.mesh_normals import face_vectors
from renderer.world.terrain import DEFAULT_CENTRE, TerrainReading, crop, default_terrain, load_terrain

NODES = 256
"""Along a side of the block."""

FLOOR = 0.12
"""How thick the block is under its lowest point, as a share of its side."""

WALL, UNDER = 3, 24
"""Height of a wall's cells in widths of one, and nodes along a side of the level floor."""

STEPS = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Shares of the height at which the colours stand."""

COLOURS = np.array([(0.07, 0.11, 0.035), (0.12, 0.17, 0.05), (0.24, 0.22, 0.10), (0.34, 0.29, 0.21), (0.7, 0.7, 0.68)])
ROCK = np.array([0.28, 0.25, 0.22])
CUT = np.array([0.2, 0.13, 0.08])
"""Linear reflectance of meadows to summits, of steep ground, and of the block's sides."""


class Relief(Model):
    """A square of land with the ground under it."""

    kind: Literal["relief"] = "relief"
    size: float = param(2.0, label="Size", help="Of its side.", unit="m", cost="bake", gt=0, le=1000)
    asset: str = param(
        "", label="File", help="An uploaded terrain, as asset:HASH; empty takes the built-in land.", cost="bake",
        pattern=r"^(asset:[0-9a-f]{64})?$", takes=("terrain",),
    )
    reading: TerrainReading = param(
        TerrainReading(), label="Reading", help="What the file leaves unsaid.", cost="bake"
    )
    side: float = param(
        4096.0, label="Side", help="Of the land that is shown, or all of a smaller one.", unit="m", cost="bake", ge=1,
        le=1e6,
    )
    exaggeration: float = param(
        1.6, label="Exaggeration", help="How much too high it is shown.", unit="ratio", cost="bake", ge=0, le=20
    )

    def solid(self) -> Solid:
        """Its triangles.

        Raises:
            InputError: the file cannot be had, or used.
        """
        land, centre = default_terrain(), DEFAULT_CENTRE
        if self.asset:
            try:
                land = load_terrain(AssetStore().get(self.asset.removeprefix("asset:")).path, reading=self.reading)
            except InputError as failure:
                own = failure.field in TerrainReading.model_fields
                raise failure.at(f"subject.reading.{failure.field}" if own else "subject.asset") from None
            centre = (0.0, 0.0)
        side = min(self.side, *land.size)
        height = crop(land, centre, side, side / NODES).elevation.astype(float)[::-1] / side * self.exaggeration
        return _block(height - height.min())


def _block(height: np.ndarray) -> Solid:
    """The closed block under heights (n, n), row 0 the south, over the unit square."""
    count = len(height)
    places = (np.arange(count) + 0.5) / count - 0.5
    x, y = np.meshgrid(places, places)
    top = np.stack([x, y, height], axis=-1).reshape(-1, 3)
    number = np.arange(count * count).reshape(count, count)
    rim = top[np.concatenate([number[0, :-1], number[:-1, -1], number[-1, :0:-1], number[:0:-1, 0]])]
    rings = 1 + int(np.ceil((FLOOR + height.max()) * count / WALL))
    foot = rim * [1, 1, 0] - [0, 0, FLOOR]
    walls = rim + (foot - rim) * (np.arange(rings + 1) / rings)[:, None, None]
    across = np.linspace(places[0], places[-1], UNDER)
    x, y = np.meshgrid(across, across)
    parts = [
        (top, grid_faces(count, count)),
        (walls.reshape(-1, 3), grid_faces(rings + 1, len(rim), around=True)[:, ::-1]),
        (np.stack([x, y, 0 * x - FLOOR], axis=-1).reshape(-1, 3), grid_faces(UNDER, UNDER)[:, ::-1]),
    ]
    vertices, faces = joined(parts)
    under = np.repeat(CUT[None], len(parts[2][1]), axis=0)
    return Solid(vertices, faces, np.concatenate([_ground(*parts[0]), _strata(*parts[1]), under]))


def _ground(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Colour by height and slope, (F, 3)."""
    z = face_middles(vertices, faces)[:, 2]
    share = z / max(float(np.quantile(z, 0.995)), 1e-9)
    colour = np.stack([np.interp(share, STEPS, COLOURS[:, k]) for k in range(3)], axis=1)
    vectors = face_vectors(vertices, faces)
    level = vectors[:, 2] / np.linalg.norm(vectors, axis=1)
    steep = np.clip((0.86 - level) / 0.12, 0, 1)[:, None]
    return colour + (ROCK - colour) * steep


def _strata(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Colour of the cut ground, in layers, (F, 3)."""
    z = face_middles(vertices, faces)[:, 2]
    return np.asarray(CUT * (1 + 0.25 * np.sin(z * 90) + 0.15 * np.sin(z * 37 + 1))[:, None])
