"""A user's own cloud: each point becomes a small square that faces along its normal, wide enough to leave no gap."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np
from scipy.spatial import cKDTree

from renderer.core.cache import AssetStore
from renderer.core.errors import InputError
from renderer.core.params import Model, param
from renderer.directional.frames import frames
from renderer.directional.morton import morton
from renderer.directional.subject.solid import Solid
from renderer.world.mesh import DEFAULT_COLOUR
from renderer.world.points import Points, PointsReading, load_points
from renderer.world.points_normals import estimated_normals

SQUARE = 0.5
"""Half a square's side over the distance to its sixth neighbour, which is the diagonal of an even lattice: its corners
then reach the corners of the cells around its point."""


class OwnPoints(Model):
    """An uploaded cloud of points."""

    kind: Literal["points"] = "points"
    asset: str = param(
        ..., label="File", help="An uploaded cloud of points, as asset:HASH.", cost="bake",
        pattern=r"^asset:[0-9a-f]{64}$", takes=("points",),
    )
    reading: PointsReading = param(PointsReading(), label="Reading", help="What the file leaves unsaid.", cost="bake")
    size: float = param(
        2.0, label="Size", help="Of its longest side, standing at the origin; 0 leaves it as it is.", unit="m",
        cost="bake", ge=0, le=1000,
    )
    most: int = param(
        1_000_000, label="Most points", help="Of a larger cloud, as many by chance.", unit="count", cost="bake",
        ge=1000, le=4_000_000,
    )
    cover: float = param(
        1.0, label="Cover", help="How wide points are, where 1 closes an even cloud.", unit="ratio", cost="bake",
        ge=0.1, le=8, step=0.1,
    )
    sides: Literal["one", "both"] = param(
        "both", label="Sides", help="From which points are seen: the front alone trusts the normals.", cost="bake"
    )

    def solid(self, progress: Callable[[float, str], None]) -> Solid:
        """Its squares.

        Raises:
            InputError: the file cannot be had, or used.
        """
        try:
            points = load_points(AssetStore().get(self.asset.removeprefix("asset:")).path, reading=self.reading)
        except InputError as failure:
            inner = f"reading.{failure.field}" if failure.field in PointsReading.model_fields else "asset"
            raise failure.at(f"subject.{inner}") from None
        return squares(points, self.most, self.cover, self.sides == "both", progress)


def squares(
    points: Points, most: int, cover: float, both: bool, progress: Callable[[float, str], None]
) -> Solid:
    """A cloud as squares, two triangles each; with normals found where it has none, which a note says."""
    position, normal, colour, notes = points.position, points.normal, points.colour, points.notes
    if len(position) > most:
        kept = np.sort(np.random.Generator(np.random.PCG64(1)).choice(len(position), most, replace=False))
        notes = (*notes, f"{most:,} of its {len(position):,} points are used")
        position = position[kept]
        normal, colour = (None if values is None else values[kept] for values in (normal, colour))
    if normal is None:
        normal, away = estimated_normals(position, progress)
        notes = (*notes, "normals are those of planes through neighbouring points, turned outwards where the cloud "
                         "closes")
    else:
        progress(0.2, "measuring distances")
        away = cKDTree(position).query(position, k=[7], workers=-1)[0][:, 0]
    if colour is None:
        colour, notes = np.full(position.shape, DEFAULT_COLOUR), (*notes, "points without a colour are grey")
    # Neighbours get neighbouring numbers, and their faces stand together.
    order = np.argsort(morton(position, float(np.median(away))), kind="stable")
    position, normal, colour, away = position[order], normal[order], colour[order], away[order]
    half = cover * SQUARE * np.minimum(away, 4 * np.median(away))[:, None]
    tangent, bitangent = frames(normal)
    corners = [position + half * (a * tangent + b * bitangent) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    faces = (4 * np.arange(len(position))[:, None, None] + np.array([(0, 1, 2), (0, 2, 3)])).reshape(-1, 3)
    source = np.repeat(np.arange(len(position)), 2)
    normals = np.broadcast_to(normal[source][:, None], (len(source), 3, 3))
    return Solid(np.stack(corners, axis=1).reshape(-1, 3), faces, colour[source], normals, both, source, notes,
                 float(np.median(half)))
