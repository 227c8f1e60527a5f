"""A moving shell on the GPU: at each moment only what moved since the last is written."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import replace
from typing import Any

import numpy as np
from numba import njit

from renderer.core.technique import Arrays
from renderer.gl.context import GL
from renderer.gl.meshes import Triangles
from renderer.shells.animation_scene import Moment
from renderer.shells.resident import Placed, base_texels, boundary_faces, faces_of, placed, tet_texels
from renderer.shells.world_scale import TET_ROW, TET_TEXELS


class Following:
    """The objects of one shell, which follow it from moment to moment.

    Args:
        gl: the context's objects. key: of the shell at rest. rest: its arrays. base: whether rays may come through the
            surface.
    """

    def __init__(self, gl: GL, key: Hashable, rest: Arrays, base: bool) -> None:
        self.key = key
        self._rest = placed(rest)
        self.centre = self._rest.centre
        self.written = 0
        """Tetrahedra written at the last moment."""
        self._shown: Hashable = None
        self._tets = tet_texels(rest, self.centre)
        self._base = base_texels(rest)
        self._tet, self._face = boundary_faces(rest["neighbour"], base)
        self._neighbour = rest["neighbour"]
        self.objects: dict[str, Any] = {
            "shell_tets": gl.texture2d(self._tets, "nearest"),
            "shell_base": gl.texture2d(self._base, "nearest"),
            "entries": Triangles(gl, *faces_of(rest, self.centre, self._tet, self._face)),
        }

    def at(self, now: Moment) -> tuple[dict[str, Any], Placed]:
        """The objects at a moment, and where the shell stands: the same whatever was shown before."""
        if self._shown != now.key:
            known = now.changed is not None and now.before == self._shown
            self._write(now, now.changed if known else np.arange(len(now.shell["tets"])))
            self._shown = now.key
        away = ((now.shell["positions"] - self.centre) ** 2).sum(axis=1)
        return self.objects, replace(self._rest, radius=float(np.sqrt(away.max())))

    def release(self) -> None:
        """Free everything."""
        for held in self.objects.values():
            held.release()

    def _write(self, now: Moment, changed: np.ndarray | None) -> None:
        shell = now.shell
        self.written = 0 if changed is None else len(changed)
        if changed is None or not len(changed):
            return
        texels = self._tets.reshape(-1, TET_TEXELS, 4)
        pack(shell["planes"], shell["to_texture"], self.centre, changed, texels)
        write_rows(self.objects["shell_tets"], self._tets, np.unique(changed // TET_ROW))
        base = base_texels(shell)
        write_rows(self.objects["shell_base"], base, np.flatnonzero((base != self._base).any(axis=(1, 2))))
        self._base = base
        moved = np.zeros(len(shell["tets"]), bool)
        moved[changed] = True
        faces = np.flatnonzero(moved[self._tet])
        if len(faces):
            run = slice(int(faces[0]), int(faces[-1]) + 1)
            corners, owner = faces_of(shell, self.centre, self._tet[run], self._face[run])
            self.objects["entries"].write(run.start, corners, owner)


@njit(cache=True, nogil=True)
def pack(planes, to_texture, centre, changed, texels):
    """Write planes and maps of some cells as `renderer.shells.resident.tet_texels` lays them out.

    Args:
        planes: (T, 4, 4). to_texture: (T, 3, 4). centre: (3,), taken for the origin. changed: (N,) cells.
        texels: (>= T, 8, 4) float32, written.
    """
    for n in changed:
        for k in range(7):
            row = planes[n, k] if k < 4 else to_texture[n, k - 4]
            texels[n, k, 0], texels[n, k, 1], texels[n, k, 2] = row[0], row[1], row[2]
            texels[n, k, 3] = row[3] + row[0] * centre[0] + row[1] * centre[1] + row[2] * centre[2]


def write_rows(texture: Any, texels: np.ndarray, rows: np.ndarray) -> None:
    """Write some rows of a texture, each run of neighbours at once.

    Args:
        texels: (rows, columns, 4) float32, all of it. rows: numbers of those that changed, rising.
    """
    for run in np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1):
        if len(run):
            first, count = int(run[0]), len(run)
            texture.write(texels[first : first + count].tobytes(), viewport=(0, first, texels.shape[1], count))
