"""The second reference of the forest: rays against the trees' own triangles, before any voxel was made.

The difference between this picture and the volume reference of the same stand prices voxelisation itself: leaves become
fog of the same coverage, their normals a mean. Opaque two-sided Lambertian faces on level ground, direct sun with hard
shadows, and a uniform sky by its visible share of the upper hemisphere, as the volume's `ambient` counts it. Hits are
found by Embree (Wald et al. 2014) in float32, about 1e-5 m off at 100 m; shading is float64.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from numpy.typing import NDArray

from renderer.core.errors import InputError
from renderer.reference.forest import Progress, Rays, Reference
from renderer.reference.forest_world import Colour3, Floats

OFFSET = 1e-3
"""Metres off the face at which secondary rays start: a hundred times Embree's rounding at 100 m, a tenth of a twig."""

MISS = -1
GROUND = -2


@dataclass(frozen=True)
class MeshWorld:
    """A stand of trees on level ground at z = 0, as triangles.

    Attributes:
        vertices: (V, 3) metres, x east, y north, z up.
        faces: (F, 3) indices.
        albedo: (F, 3) linear reflectance, the same on both sides.
        ground_albedo: of the level ground, endless.
        e_sun: irradiance on a plane facing the sun, W m-2, by channel.
        e_sky: irradiance of the sky on the horizontal.
        sun: unit vector to the sun.
        background: radiance behind everything for directions (M, 3) -> (M, 3); None leaves it empty.
    """

    vertices: NDArray[np.floating]
    faces: NDArray[np.integer]
    albedo: NDArray[np.floating]
    ground_albedo: Colour3
    e_sun: Colour3
    e_sky: Colour3
    sun: Colour3
    background: Callable[[Floats], Floats] | None = None

    def __post_init__(self) -> None:
        """Refuse arrays that are no mesh.

        Raises:
            InputError: naming the wrong one.
        """
        if self.vertices.ndim != 2 or self.vertices.shape[1] != 3 or not np.isfinite(self.vertices).all():
            raise InputError("vertices", f"has shape {self.vertices.shape}", "(V, 3) finite metres")
        if self.faces.ndim != 2 or self.faces.shape[1] != 3 or not len(self.faces):
            raise InputError("faces", f"has shape {self.faces.shape}", "(F, 3), F at least 1")
        if self.faces.min() < 0 or self.faces.max() >= len(self.vertices):
            raise InputError("faces", "names a vertex that is not there", f"0 to {len(self.vertices) - 1}")
        if self.albedo.shape != (len(self.faces), 3):
            raise InputError("albedo", f"has shape {self.albedo.shape}", f"({len(self.faces)}, 3)")


class _Stand:
    """The triangles in Embree, with their float64 normals."""

    def __init__(self, world: MeshWorld) -> None:
        corners = np.asarray(world.vertices, np.float64)[world.faces]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        whole = length[:, 0] > 0
        self.normals = normals[whole] / length[whole]
        self.albedo = np.asarray(world.albedo, np.float64)[whole]
        self.scene = EmbreeScene()
        # Embree keeps no copy: the mesh and its buffer must live as long as the scene
        self.corners = np.ascontiguousarray(corners[whole], np.float32)
        self.mesh = TriangleMesh(self.scene, self.corners)

    def closest(self, origins: Floats, directions: Floats) -> tuple[NDArray[np.int64], Floats]:
        """Face met first (MISS, GROUND or its number) and its distance."""
        found = self.scene.run(origins.astype(np.float32), directions.astype(np.float32), output=True)
        face = found["primID"].astype(np.int64)
        distance = np.where(face >= 0, found["tfar"].astype(np.float64), np.inf)
        with np.errstate(divide="ignore", invalid="ignore"):
            to_ground = np.where(directions[:, 2] < 0, -origins[:, 2] / directions[:, 2], np.inf)
        lower = to_ground < distance
        return np.where(lower, GROUND, face), np.where(lower, to_ground, distance)

    def blocked(self, origins: Floats, directions: Floats) -> NDArray[np.bool_]:
        """Whether anything stands in the way of rays that go up."""
        found = self.scene.run(origins.astype(np.float32), directions.astype(np.float32), query="OCCLUDED")
        return np.asarray(found) != MISS


def render(
    world: MeshWorld,
    rays: Rays,
    positions: NDArray[np.floating],
    sky_rays: int = 16,
    seed: int = 1,
    progress: Progress | None = None,
) -> Reference:
    """Cast the reference picture.

    Args:
        world: the stand.
        rays: origins and unit directions (H, W, 3) for one position within the pixels.
        positions: (S, 2) across and down from each pixel's top left corner, in pixels.
        sky_rays: rays to the sky from each hit, evenly spread over the upper hemisphere's solid angle.
        seed: of their rotation.
        progress: told the share done; raises `Cancelled` to stop.

    Raises:
        InputError: no positions or no sky rays.
        Cancelled: by `progress`.
    """
    offsets = np.asarray(positions, np.float64)
    if offsets.ndim != 2 or offsets.shape[1] != 2 or not len(offsets):
        raise InputError("positions", f"has shape {offsets.shape}", "(S, 2), S at least 1")
    if sky_rays < 1:
        raise InputError("sky_rays", "the sky needs a ray", "at least 1")
    begun = time.perf_counter()
    stand, rng = _Stand(world), np.random.default_rng(seed)
    total: Floats | None = None
    squares = np.zeros(1)
    for number, (across, down) in enumerate(offsets):
        origins, directions = rays((float(across), float(down)))
        shape = origins.shape[:2]
        found, variance = _sample(stand, world, origins.reshape(-1, 3), directions.reshape(-1, 3), sky_rays, rng)
        total = found.reshape(*shape, 4) + (0 if total is None else total)
        squares = squares + variance.reshape(shape)
        if progress is not None:
            progress((number + 1) / len(offsets), "casting the reference")
    assert total is not None
    return Reference(total / len(offsets), np.sqrt(squares) / len(offsets), time.perf_counter() - begun)


def _sample(stand: _Stand, world: MeshWorld, origins: Floats, directions: Floats, sky_rays: int,
            rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Radiance (M, 4) along M rays, and the variance of its mean over the channels (M,)."""
    face, distance = stand.closest(origins, directions)
    hit = face != MISS
    radiance, variance = np.zeros((len(face), 4)), np.zeros(len(face))
    if world.background is not None:
        radiance[~hit, :3] = world.background(directions[~hit])
    on_ground = face[hit] == GROUND
    number = np.where(on_ground, 0, face[hit])
    normal = np.where(on_ground[:, None], (0.0, 0.0, 1.0), stand.normals[number])
    # both sides reflect alike, so a face turns its normal to the eye
    normal *= -np.sign(np.sum(normal * directions[hit], axis=1, keepdims=True))
    albedo = np.where(on_ground[:, None], world.ground_albedo, stand.albedo[number])
    place = origins[hit] + directions[hit] * distance[hit, None] + OFFSET * normal
    # a leaf that touches the ground must not look at the sky from below it
    place[:, 2] = np.maximum(place[:, 2], OFFSET)
    facing = np.maximum(normal @ np.asarray(world.sun), 0.0)
    if world.sun[2] <= 0:
        facing[:] = 0.0
    seen = np.zeros(len(place))
    lit = facing > 0
    seen[lit] = ~stand.blocked(place[lit], np.broadcast_to(np.asarray(world.sun), (int(lit.sum()), 3)))
    share = _sky_share(stand, place, sky_rays, rng)
    sky = share * np.where(on_ground, 0.5 * (1 + normal[:, 2]), 1.0)
    light = (seen * facing)[:, None] * world.e_sun + sky[:, None] * world.e_sky
    radiance[hit, :3] = albedo / np.pi * light
    radiance[hit, 3] = 1.0
    variance[hit] = (np.mean(albedo * world.e_sky, axis=1) / np.pi) ** 2 * share * (1 - share) / sky_rays
    return radiance, variance


def _sky_share(stand: _Stand, place: Floats, sky_rays: int, rng: np.random.Generator) -> Floats:
    """Unblocked share of the upper hemisphere's solid angle above each place.

    Directions follow a Fibonacci spiral (even in height, golden-angle azimuths), turned and shifted at random a place.
    """
    clear = np.zeros(len(place))
    shift, turn = rng.random(len(place)), rng.random(len(place))
    golden = 0.5 * (np.sqrt(5.0) - 1.0)
    for k in range(sky_rays):
        z = (k + shift) / sky_rays
        azimuth = 2 * np.pi * (k * golden + turn)
        flat = np.sqrt(1 - z * z)
        directions = np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), z], axis=1)
        clear += ~stand.blocked(place, directions)
    return clear / sky_rays
