"""Surfaces that move: deformations of the base mesh by time, and the shell that follows them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from renderer.core.params import Model, param
from renderer.core.technique import Arrays
from renderer.shells.animation_frames import KeyFrames, key_frames
from renderer.shells.base_mesh import BaseMesh
from renderer.shells.course import Course, between
from renderer.shells.extrusion import Extrusion, directions
from renderer.shells.shell import Shell, update_shell
from renderer.shells.shell_bake import shell_of
from renderer.shells.surfaces import surface_of
from renderer.world.mesh_normals import vertex_normals

MOVING = ("positions", "planes", "to_texture", "volumes")
"""Arrays of a shell that change as it moves; the others hold its topology."""

WAVES = 8
"""Plane waves of each component of the noise."""


def period(seconds: float) -> Any:
    """The parameter of how long a motion takes to come back."""
    return param(
        seconds, label="Period", help="After which it comes back.", unit="s", cost="host", gt=0, le=3600, step=0.1
    )


def frames() -> Any:
    """The parameter of how many key frames planes and maps are interpolated between."""
    return param(
        0, label="Key frames", unit="count", cost="host", ge=0, le=64, source="Dufort 2005, section 5.3.3",
        help="Of which planes and maps are computed once and interpolated; 0 computes them at every moment.",
    )


class Still(Model):
    """No motion."""

    kind: Literal["still"] = "still"


class NoiseMotion(Model):
    """Noise on the vertices."""

    kind: Literal["noise"] = "noise"
    amplitude: float = param(
        0.06, label="Amplitude", help="By how much a place moves along x, y and z: root mean square.", unit="m",
        cost="host", ge=0, le=100, source="Dufort 2005, figures 5.12 and 6.5",
    )
    size: float = param(0.8, label="Size", help="Length of its waves.", unit="m", cost="host", gt=0, le=1000)
    period: float = period(6.0)
    frames: int = frames()
    seed: int = param(5, label="Seed", help="Of the waves.", cost="host", ge=0, le=2**31 - 1)


class Bend(Model):
    """Bends to and fro about the y axis, its foot fixed."""

    kind: Literal["bend"] = "bend"
    angle: float = param(
        60.0, label="Angle", help="Between foot and top when it is bent most.", unit="deg", cost="host", ge=0, le=180,
        source="Barr 1984",
    )
    period: float = period(6.0)
    frames: int = frames()


class Twist(Model):
    """Twists to and fro about the z axis."""

    kind: Literal["twist"] = "twist"
    angle: float = param(
        90.0, label="Angle", help="Between foot and top when it is twisted most.", unit="deg", cost="host", ge=0,
        le=720, source="Barr 1984",
    )
    period: float = period(6.0)
    frames: int = frames()


class Bump(Model):
    """A bump that wanders around the z axis: all but its surroundings stays as it is."""

    kind: Literal["bump"] = "bump"
    height: float = param(0.12, label="Height", help="Of its top.", unit="m", cost="host", ge=-100, le=100)
    radius: float = param(0.35, label="Radius", help="How far it reaches.", unit="m", cost="host", gt=0, le=1000)
    period: float = period(8.0)
    frames: int = frames()


class Keyed(Model):
    """By the key frames: their bend, twist and swell."""

    kind: Literal["keys"] = "keys"
    planes: Literal["computed", "interpolated"] = param(
        "computed",
        label="Planes and maps",
        help="Computed at every moment, as its vertices are; or once in every key frame, and interpolated with them.",
        cost="host",
        source="Dufort 2005, section 5.3.3",
    )


Motion = Annotated[Still | NoiseMotion | Bend | Twist | Bump | Keyed, Field(discriminator="kind")]


@dataclass(frozen=True)
class Posed:
    """Motion by key frames, with all that it depends on.

    Args:
        poses: time [s], bend, twist [deg] and swell [m] of each key frame, by rising times. period: of a round, s.
        planes: as `Keyed` has it.
    """

    poses: tuple[tuple[float, float, float, float], ...]
    period: float
    planes: Literal["computed", "interpolated"]

    @property
    def frames(self) -> int:
        """Key frames between which planes and maps are interpolated; 0 computes them at every moment."""
        return len(self.poses) if self.planes == "interpolated" else 0

    def at(self, time: float) -> tuple[float, float, float]:
        """Bend, twist [rad] and swell [m] at a time [s]: even between two key frames."""
        early, late, share = between([pose[0] for pose in self.poses], self.period, time)
        one, other = self.poses[early], self.poses[late]
        bend, twist, swell = (one[k] + share * (other[k] - one[k]) for k in (1, 2, 3))
        return math.radians(bend), math.radians(twist), swell


Moving = NoiseMotion | Bend | Twist | Bump | Posed

AnyMotion = Still | Moving


def motion_of(motion: Still | NoiseMotion | Bend | Twist | Bump | Keyed, course: Course) -> AnyMotion:
    """What a document's motion does: that by key frames knows them; it is still where they pose nothing."""
    if not isinstance(motion, Keyed):
        return motion
    keys = sorted(course.keys, key=lambda key: key.at)
    if not any(key.bend or key.twist or key.swell for key in keys):
        return Still()
    return Posed(tuple((key.at, key.bend, key.twist, key.swell) for key in keys), course.period, motion.planes)


def frame_times(motion: Moving) -> tuple[float, ...]:
    """Times of a motion's key frames [s], rising."""
    if isinstance(motion, Posed):
        return tuple(pose[0] for pose in motion.poses)
    return tuple(motion.period * number / motion.frames for number in range(motion.frames))


def deformed(base: BaseMesh, motion: AnyMotion, time: float) -> np.ndarray:
    """The vertices (V, 3) [m] of a mesh at a time [s]; at 0 and after each period bend and twist leave it as it is."""
    if isinstance(motion, Posed):
        return _posed(base, *motion.at(time))
    phase = 0.0 if isinstance(motion, Still) else 2 * math.pi * time / motion.period
    if isinstance(motion, NoiseMotion):
        return base.vertices + motion.amplitude * _waves(base.vertices, motion, phase)
    if isinstance(motion, Bend):
        return bent(base.vertices, math.radians(motion.angle) * math.sin(phase))
    if isinstance(motion, Twist):
        return twisted(base.vertices, math.radians(motion.angle) * math.sin(phase))
    if isinstance(motion, Bump):
        return _bumped(base, motion, phase)
    return base.vertices


def bent(vertices: np.ndarray, angle: float) -> np.ndarray:
    """Places bent about the y axis by an angle [rad] from the lowest to the highest: the z axis becomes an arc of its
    own length (Barr 1984, "Global and local deformations of solid primitives", section 5.5)."""
    low, high = vertices[:, 2].min(), vertices[:, 2].max()
    if abs(angle) < 1e-9 or high == low:
        return vertices.copy()
    radius = (high - low) / angle
    turn = (vertices[:, 2] - low) / radius
    away = radius - vertices[:, 0]
    return np.stack([radius - away * np.cos(turn), vertices[:, 1], low + away * np.sin(turn)], axis=-1)


def twisted(vertices: np.ndarray, angle: float) -> np.ndarray:
    """Places turned about the z axis, by an angle [rad] between the lowest and the highest (Barr 1984)."""
    low, high = vertices[:, 2].min(), vertices[:, 2].max()
    share = (vertices[:, 2] - (low + high) / 2) / max(high - low, 1e-300)
    c, s = np.cos(angle * share), np.sin(angle * share)
    x, y, z = vertices.T
    return np.stack([c * x - s * y, s * x + c * y, z], axis=-1)


def positions_at(
    base: BaseMesh, length: np.ndarray, extrusion: Extrusion, motion: AnyMotion, time: float
) -> np.ndarray:
    """Where the shell's vertices are at a time [s], (2V, 3) [m].

    Args:
        base: the mesh at rest.
        length: (V,) of its offsets at rest, clamped, which they keep, m; their directions are those of the mesh as it
            is at that time.
    """
    vertices = deformed(base, motion, time)
    way, _ = directions(vertices, base.faces, extrusion)
    return np.concatenate([vertices, vertices + way * length[:, None]])


class MovingShell:
    """A baked shell that follows a motion: at each time only what moved since the last is computed.

    Dufort 2005, section 5.3.3: tetrahedra that a deformation changed are marked, and planes and maps of these alone
    are computed again.

    Args:
        surface, shell: arrays of the bakes. extrusion: the document's.
    """

    def __init__(self, surface: Arrays, shell: Arrays, extrusion: Extrusion) -> None:
        self._base, self._extrusion = surface_of(surface), extrusion
        self._length = shell["wanted"] * shell["share"]
        self._kept: tuple[AnyMotion, KeyFrames] | None = None
        self.shell: Shell = shell_of(shell)

    def move(self, motion: AnyMotion, time: float) -> np.ndarray:
        """Go to a time [s], and return the numbers of the tetrahedra that changed, (N,)."""
        positions = positions_at(self._base, self._length, self._extrusion, motion, time)
        self.shell, changed = update_shell(self.shell, positions)
        return changed

    def interpolate(self, motion: Moving, time: float) -> None:
        """Go to a time [s] between the motion's key frames; these are computed when they are first wanted."""
        if self._kept is None or self._kept[0] != motion:
            times = frame_times(motion)
            places = [positions_at(self._base, self._length, self._extrusion, motion, then) for then in times]
            self._kept = motion, key_frames(self.shell, places, times, motion.period)
        self.shell = self._kept[1].at(time)

    def arrays(self, surface: Arrays, shell: Arrays) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
        """Arrays like those of the bakes, of the surface and the shell as they are now."""
        vertices = self.shell.positions[: len(self._base.vertices)]
        moved = {name: getattr(self.shell, name) for name in MOVING}
        normals = vertex_normals(vertices, self._base.faces)
        return {**surface, "vertices": vertices, "normals": normals}, {**shell, **moved}


def _waves(places: np.ndarray, motion: NoiseMotion, phase: float) -> np.ndarray:
    """Displacement (N, 3) of root mean square 1 in each component, periodic in the phase [rad]."""
    rng = np.random.default_rng(motion.seed)
    way = rng.normal(size=(3, WAVES, 3))
    way *= 2 * math.pi / motion.size / np.linalg.norm(way, axis=-1, keepdims=True)
    start = rng.uniform(0, 2 * math.pi, (3, WAVES))
    pace = rng.choice([-2.0, -1.0, 1.0, 2.0], (3, WAVES))
    angle = np.einsum("nk,cwk->ncw", places, way) + start + pace * phase
    total: np.ndarray = np.sin(angle).sum(axis=-1) / math.sqrt(WAVES / 2)
    return total


def _posed(base: BaseMesh, bend: float, twist: float, swell: float) -> np.ndarray:
    """Swollen along the normals, then twisted, then bent."""
    vertices = base.vertices
    if swell:
        vertices = vertices + swell * vertex_normals(base.vertices, base.faces)
    return bent(twisted(vertices, twist) if twist else vertices, bend)


def _bumped(base: BaseMesh, motion: Bump, phase: float) -> np.ndarray:
    low, high = base.vertices.min(axis=0), base.vertices.max(axis=0)
    reach = 0.4 * (high - low)
    middle = (low + high) / 2 + (reach[0] * math.cos(phase), reach[1] * math.sin(phase), 0.0)
    away = np.linalg.norm(base.vertices - middle, axis=1) / motion.radius
    height = np.where(away < 1, motion.height * (1 - away**2) ** 2, 0.0)
    return base.vertices + vertex_normals(base.vertices, base.faces) * height[:, None]
