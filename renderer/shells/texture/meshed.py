"""A mesh as a 3D texture: section 3.2 of Dufort 2005.

The thesis fills the inside by a flag along each column, which hand-made repairs had to follow; here the generalised
winding number decides, also for open and self-intersecting meshes.
"""

from __future__ import annotations

import math
from typing import ClassVar, Literal

import numpy as np
from scipy.ndimage import distance_transform_edt

from renderer.core.cache import AssetStore
from renderer.core.errors import InputError
from renderer.core.params import param
from renderer.shells.texture.block import Matter
from renderer.shells.texture.source import Procedure, unit, with_glow
from renderer.shells.texture.winding import winding_numbers
from renderer.world.mesh import Mesh, MeshReading, load_mesh
from renderer.world.voxelise import Grid, Voxels, voxelise

SUB = 3
"""Points a voxel's side at which voxels that the surface crosses are asked for inside."""

BLOCK = 4
"""Voxels a side of the blocks that one point may tell from outside."""

MARGIN = 0.04
"""Left free around a mesh, where the shell is 1 high."""


class Meshed(Procedure):
    """A mesh, its inside filled."""

    seconds: ClassVar[float] = 6.0
    kind: Literal["mesh"] = "mesh"
    asset: str = param(
        "", label="File", help="An uploaded mesh, as asset:HASH; empty takes a trefoil knot.", cost="bake",
        pattern=r"^(asset:[0-9a-f]{64})?$", takes=("mesh",),
    )
    reading: MeshReading = param(MeshReading(), label="Reading", help="What the file leaves unsaid.", cost="bake")
    copies: Literal[1, 2, 4, 8] = param(
        1, label="Copies", help="Along each side of the repeated square.", unit="count", cost="bake"
    )
    azimuth: float = param(
        0.0, label="Turn", help="About the vertical, from north by east.", unit="deg", cost="bake", ge=-360, le=360
    )
    sunk: float = param(
        0.0, label="Sunk", help="Share of its height below the base surface.", unit="ratio", cost="bake", ge=0, le=0.9,
        step=0.05,
    )
    opacity: float = param(
        1.0, label="Opacity", help="Of a voxel of its inside.", unit="ratio", cost="bake", ge=0, le=1, step=0.01
    )

    def matter(self) -> Matter:
        """The mesh once or several times, as large as fits; colour and normal inside are those of the surface that is
        nearest. Open meshes keep their sheets too."""
        mesh = self._mesh()
        block = self.model_copy(update={"across": max(8, self.across // self.copies), "copies": 1})
        vertices = block._placed(mesh)
        step = 1.0 / block.layers
        grid = Grid(np.zeros(3), np.eye(3) * step, (block.across, block.across, block.layers))
        skin = voxelise(vertices, mesh.faces, mesh.face_colour, grid)
        cover = block._filled(vertices, mesh.faces, skin)
        notes = mesh.notes
        if not mesh.watertight:
            cover = np.maximum(cover, skin.opacity())
            notes = (*notes, "the mesh is open: its inside is where it winds around by more than a half")
        normal, colour = _nearest(skin)
        rgba = np.concatenate([colour, (cover * self.opacity)[..., None]], axis=-1).astype(np.float32)
        times = (1, self.copies, self.copies, 1)
        rgba, normal = np.tile(rgba, times), np.tile(with_glow(normal), times)
        return Matter(rgba, normal, (rgba[..., 3] > 0).astype(np.uint8), notes=notes)

    def _mesh(self) -> Mesh:
        if not self.asset:
            return knot()
        try:
            return load_mesh(AssetStore().get(self.asset.removeprefix("asset:")).path, reading=self.reading)
        except InputError as failure:
            own = failure.field in MeshReading.model_fields
            raise failure.at(f"texture.reading.{failure.field}" if own else "texture.asset") from None

    def _placed(self, mesh: Mesh) -> np.ndarray:
        """Its vertices (V, 3) on the base surface, in the middle, where the height is 1."""
        turn = math.radians(self.azimuth)
        spin = np.array([[math.cos(turn), math.sin(turn), 0], [-math.sin(turn), math.cos(turn), 0], [0, 0, 1]])
        used = mesh.vertices[np.unique(mesh.faces)] @ spin.T
        low, high = used.min(axis=0), used.max(axis=0)
        room = np.array([self.side - 2 * MARGIN, self.side - 2 * MARGIN, (1 - MARGIN) / (1 - self.sunk)])
        scale = float((room / np.maximum(high - low, 1e-9)).min())
        middle = (low + high) / 2
        foot = np.array([middle[0], middle[1], low[2] + self.sunk * (high[2] - low[2])])
        return (mesh.vertices @ spin.T - foot) * scale + np.array([self.side / 2, self.side / 2, 0.0])

    def _filled(self, vertices: np.ndarray, faces: np.ndarray, skin: Voxels) -> np.ndarray:
        """Share of each voxel inside the mesh, (K, J, I): from one point, or from SUB^3 where the surface crosses."""
        crossed = skin.area > 0
        share = np.zeros(self.shape, np.float32)
        number, blocks = _blocks(self.shape)
        cut = np.bincount(number.ravel(), crossed.ravel(), len(blocks)) > 0
        # Between surfaces the winding number is harmonic: one point tells a block where it is far from a half.
        middle = np.abs(winding_numbers(vertices, faces, (blocks + 0.5) / self.layers))
        unsure = cut | (np.abs(middle - 0.5) < 0.2)
        share[...] = (middle >= 0.5)[number]
        points = self.points().reshape(*self.shape, 3)
        single = unsure[number] & ~crossed
        share[single] = np.abs(winding_numbers(vertices, faces, points[single])) >= 0.5
        offsets = (np.stack(np.meshgrid(*[np.arange(SUB)] * 3), axis=-1).reshape(-1, 3) + 0.5) / SUB - 0.5
        inner = (points[crossed][:, None] + offsets / self.layers).reshape(-1, 3)
        share[crossed] = (np.abs(winding_numbers(vertices, faces, inner)) >= 0.5).reshape(-1, SUB**3).mean(axis=1)
        return share


def _blocks(shape: tuple[int, int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Number of the block that each voxel (K, J, I) belongs to, and the blocks' middle (B, 3) in voxels' indices."""
    counts = [-(-length // BLOCK) for length in shape]
    parts = [np.arange(length) // BLOCK for length in shape]
    number = (parts[0][:, None, None] * counts[1] + parts[1][None, :, None]) * counts[2] + parts[2][None, None, :]
    middles = [np.minimum(np.arange(count) * BLOCK + (BLOCK - 1) / 2, length - 1)
               for count, length in zip(counts, shape)]
    grid = np.stack(np.meshgrid(*middles, indexing="ij"), axis=-1)
    return number, grid.reshape(-1, 3)[:, ::-1]


def _nearest(skin: Voxels) -> tuple[np.ndarray, np.ndarray]:
    """Normal and colour (K, J, I, 3) of the surface nearest to each voxel; it may be the next copy's, across a side
    of the block."""
    rim = skin.area.shape[1] // 2
    here = np.pad(skin.area > 0, ((0, 0), (rim, rim), (rim, rim)), mode="wrap")
    if not here.any():
        return np.zeros_like(skin.normal), np.zeros_like(skin.attributes)
    at = distance_transform_edt(~here, return_distances=False, return_indices=True)
    at = at[:, :, rim:rim + skin.area.shape[1], rim:rim + skin.area.shape[2]]
    k, j, i = at[0], (at[1] - rim) % skin.area.shape[1], (at[2] - rim) % skin.area.shape[2]
    return unit(skin.normal)[k, j, i], skin.mean_attributes()[k, j, i]


def knot(bones: int = 160, around: int = 16) -> Mesh:
    """A trefoil knot, closed, thrice as wide as high, its colour turning along it."""
    t = 2 * np.pi * np.arange(bones) / bones
    curve = np.stack([np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), -np.sin(3 * t)], axis=1)
    ahead = np.roll(curve, -1, axis=0) - np.roll(curve, 1, axis=0)
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    aside = np.cross(ahead, np.array([0.0, 0.0, 1.0]))
    aside /= np.linalg.norm(aside, axis=1, keepdims=True)
    above = np.cross(aside, ahead)
    turn = 2 * np.pi * np.arange(around) / around
    ring = np.cos(turn)[:, None] * aside[:, None] + np.sin(turn)[:, None] * above[:, None]
    vertices = (curve[:, None] + 0.62 * ring).reshape(-1, 3)
    bone, side = np.meshgrid(np.arange(bones), np.arange(around), indexing="ij")
    a, b = bone * around + side, bone * around + (side + 1) % around
    c, d = (bone + 1) % bones * around + side, (bone + 1) % bones * around + (side + 1) % around
    faces = np.stack([np.stack([a, c, b], -1), np.stack([b, c, d], -1)], axis=2).reshape(-1, 3)
    phase = 2 * np.pi * bone[..., None] / bones + np.array([0.0, 2.1, 4.2])
    colour = np.repeat((0.45 + 0.3 * np.cos(phase)).reshape(-1, 3), 2, axis=0)
    return Mesh(vertices, faces.astype(np.int32), colour, watertight=True)
