"""The shells as plain arrays and numbers, for whoever draws them without the techniques: the reference."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from renderer.core.technique import Arrays
from renderer.shells.animation import motion_of
from renderer.shells.animation_scene import moment
from renderer.shells.base_picture import laid_by, placing
from renderer.shells.course import texture_moment
from renderer.shells.texture.block import texture_of
from renderer.shells.things import placed_things
from renderer.world.sky import sky_for, sky_radiance
from renderer.world.sun import angles, direction

if TYPE_CHECKING:
    from renderer.shells.state import ShellsState

NEEDS = ("sky", "surface", "shell", "texture", "picture", "things")
"""Bakes that make the world."""


def world_arrays(state: ShellsState, baked: Mapping[str, Arrays]) -> dict[str, Any]:
    """What stands where, and the light it stands in.

    Args:
        state: the document; techniques but the light, and the view, are no part of the world.
        baked: arrays of `NEEDS`.

    Returns:
        By name, as `renderer.reference.shells_world.ShellsWorld` takes them: the shell's tetrahedra, the texture as it
        is at the moment, the light, the surface under the shell where it is opaque, as plain arrays `base`, other
        meshes likewise as `things`, and the background.
    """
    elevation = angles(state.sun)[1]
    now, sun = sky_for(baked["sky"], elevation), direction(state.sun)
    motion = motion_of(state.motion, state.course)
    at = moment(baked["surface"], baked["shell"], state.extrusion, motion, state.time)
    shell = at.shell
    then = texture_moment(state.texture, state.course, state.time, state.voxels.wrap == "repeat")
    texture = texture_of(baked["texture"], state.extrusion.thickness, **then.words)
    return {
        "positions": shell["positions"],
        "tets": shell["tets"],
        "texture": shell["texture"] + (*then.slide, 0.0),
        "colour": texture.colour,
        "reference_length": texture.reference_length / max(state.voxels.density * then.opacity, 1e-9),
        "normal": texture.normal,
        "size": texture.size,
        "interpolation": state.voxels.interpolation,
        "wrap": state.voxels.wrap,
        "light": state.light.kind,
        "level": getattr(state.light, "level", 1.0),
        "glow_radiance": (state.voxels.glow,) * 3,
        "sun": tuple(float(v) for v in sun),
        "e_sun": tuple(float(v) for v in now.sun_irradiance),
        "e_sky": tuple(float(v) for v in now.sky_irradiance),
        "base": _base(state, at.surface, baked.get("picture", {}).get("picture")) if state.base.opaque else None,
        "things": _things(state, baked["things"]) if "things" in baked else None,
        "background": lambda directions: sky_radiance(now, sun, directions),
    }


def _base(state: ShellsState, surface: Arrays, picture: np.ndarray | None) -> dict[str, Any]:
    """Corners, reflectance and normals of the surface, (F, 3, 3) each, and the picture on it (H, W, 3)."""
    faces = surface["faces"]
    corners = surface["vertices"][faces]
    plain = {
        "corners": corners,
        "albedo": np.broadcast_to(np.asarray(state.base.colour), corners.shape),
        "normals": surface["normals"][faces],
    }
    if picture is None:
        return plain
    globe = laid_by(state.picture, True) == "globe"
    repeats, turn = placing(state.picture)
    uv = np.broadcast_to((-turn, 0.0), (*faces.shape, 2)) if globe else surface["corner_uv"] * repeats
    return {**plain, "picture": picture, "globe": globe, "uv": uv}


def _things(state: ShellsState, shapes: Arrays) -> dict[str, Any]:
    """Corners, reflectance and normals of all other meshes, (F, 3, 3) each."""
    placed = placed_things(state.things, shapes)
    albedo = np.repeat(placed.albedo[:, None], 3, axis=1)
    return {"corners": placed.corners, "albedo": albedo, "normals": placed.normals}
