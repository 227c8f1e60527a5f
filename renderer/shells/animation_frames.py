"""Key frames of a shell: planes and maps computed beforehand and interpolated, and what that errs by.

Dufort 2005, section 5.3.3, proposes them for animation by key frames. A plane or a map is no linear function of the
vertices, so what is interpolated fits the interpolated vertices only nearly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from renderer.core.errors import LimitError
from renderer.shells.course import between
from renderer.shells.shell import Shell, update_shell

MOST_BYTES = 1 << 30
"""Of a scene's key frames: its vertices, planes and maps."""


@dataclass(frozen=True)
class KeyFrames:
    """Shells at some times of a motion that repeats.

    Args:
        shells: one for each key frame, of one topology. times: of the key frames, rising, s. period: of the motion, s.
    """

    shells: tuple[Shell, ...]
    times: tuple[float, ...]
    period: float

    @property
    def nbytes(self) -> int:
        """Bytes of what is kept for each key frame: vertices, planes and maps."""
        return sum(s.positions.nbytes + s.planes.nbytes + s.to_texture.nbytes for s in self.shells)

    def at(self, time: float) -> Shell:
        """The shell at a time [s]: vertices, planes and maps between those of the two nearest key frames.

        Planes get normals of unit length again; `volumes` stay those of the earlier key frame.
        """
        first, second, share = between(self.times, self.period, time)
        early, late = self.shells[first], self.shells[second]
        if share == 0:
            return early
        planes = early.planes + share * (late.planes - early.planes)
        planes /= np.maximum(np.linalg.norm(planes[..., :3], axis=-1, keepdims=True), 1e-300)
        return replace(
            early,
            positions=early.positions + share * (late.positions - early.positions),
            planes=planes,
            to_texture=early.to_texture + share * (late.to_texture - early.to_texture),
        )


def key_frames(shell: Shell, positions: Sequence[np.ndarray], times: Sequence[float], period: float) -> KeyFrames:
    """Key frames from where the shell's vertices are in each, (2V, 3) [m].

    Raises:
        LimitError: `course.keys`, more bytes than `MOST_BYTES`.
    """
    one = shell.positions.nbytes + shell.planes.nbytes + shell.to_texture.nbytes
    if len(positions) * one > MOST_BYTES:
        size = len(positions) * one >> 20
        refused = f"{len(positions)} key frames of {len(shell.tets):,} tetrahedra take {size:,} MiB"
        raise LimitError("course.keys", refused, f"{MOST_BYTES // one} key frames, or planes computed at every moment")
    return KeyFrames(tuple(update_shell(shell, places)[0] for places in positions), tuple(times), period)


@dataclass(frozen=True)
class FrameError:
    """What interpolated planes and maps err by against the shell computed at one time.

    Args:
        texture: root mean square of the texture coordinates' error at the tetrahedra's corners, u, v and w, (3,).
        texture_most: the largest.
        plane: root mean square distance of corners to the planes that should hold them, m. plane_most: the largest.
        place: root mean square distance of the vertices to where the motion has them, m. place_most: the largest.
    """

    texture: np.ndarray
    texture_most: float
    plane: float
    plane_most: float
    place: float
    place_most: float


def frame_error(between: Shell, exact: Shell) -> FrameError:
    """What an interpolated shell errs by.

    The first two against its own vertices, so that they are 0 where planes and maps fit the vertices that are drawn;
    the third against the exact shell's.
    """
    corners = between.positions[between.tets]
    sound = exact.volumes != 0
    mapped = np.einsum("nab,nkb->nka", between.to_texture[..., :3], corners) + between.to_texture[:, None, :, 3]
    texture = (mapped - between.texture)[sound]
    distance = np.einsum("nfb,nkb->nfk", between.planes[..., :3], corners) + between.planes[..., 3:]
    own = distance[:, ~np.eye(4, dtype=bool)][sound]
    place = np.linalg.norm(between.positions - exact.positions, axis=1)
    return FrameError(
        np.sqrt((texture**2).mean(axis=(0, 1))),
        float(np.abs(texture).max()),
        float(np.sqrt((own**2).mean())),
        float(np.abs(own).max()),
        float(np.sqrt((place**2).mean())),
        float(place.max()),
    )
