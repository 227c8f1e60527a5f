"""Draws the shells on the GL thread."""

from __future__ import annotations

import functools
from collections import OrderedDict
from collections.abc import Hashable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from renderer.core.params import uniforms
from renderer.core.technique import Arrays, BakedArrays
from renderer.gl.context import GL
from renderer.gl.meshes import Triangles
from renderer.gl.program import AnyTexture
from renderer.gl.resident import Resident
from renderer.gl.source import Source
from renderer.gl.targets import run_fullscreen
from renderer.gl.textures import Wrap
from renderer.shells.animation import motion_of
from renderer.shells.animation_scene import Animator, Moment
from renderer.shells.base_picture import halves, laid_by, picture_values
from renderer.shells.course import texture_moment
from renderer.shells.entries import Entries
from renderer.shells.following import Following
from renderer.shells.frame import Frame, moved
from renderer.shells.levels import pixel, sides, suited
from renderer.shells.raster import Rasters
from renderer.shells.resident import Placed, placed, shell_objects
from renderer.shells.texture.block import reference_length, texture_of
from renderer.shells.textures import Uploaded, upload
from renderer.shells.thing_mesh import ThingMeshes
from renderer.world.camera import Orthographic, pose
from renderer.world.sky import sky_for, sky_uniforms
from renderer.world.sun import angles, direction

if TYPE_CHECKING:
    from renderer.shells.state import ShellsState

Baked = Mapping[str, BakedArrays]
Prepared = tuple[Source, dict[str, AnyTexture], dict[str, Any]]

SHELLS_KEPT, TEXTURES_KEPT = 4, 4
"""Shells and textures that stay on the GPU."""


class ShellsRenderer:
    """Shells and textures on the GPU, and the frames drawn with them; one serves every view of the process."""

    def __init__(self, gl: GL) -> None:
        self._gl = gl
        self._sky = Resident(gl, 8)
        self._tables = Resident(gl, 4)
        self._animator = Animator()
        self._following: Following | None = None
        self._shells: OrderedDict[Hashable, tuple[dict[str, Any], Placed]] = OrderedDict()
        self._textures: OrderedDict[Hashable, Uploaded] = OrderedDict()
        self.entries = Entries(gl)
        self.rasters = Rasters(gl)
        self._things = ThingMeshes(gl)

    def prepare(
        self, state: ShellsState, baked: Baked, size: tuple[int, int], offset: tuple[float, float], sample: int
    ) -> Prepared:
        """Draw what a sample needs before its one full-screen pass.

        Args:
            state, baked: the document and what it needed baked.
            size: (width, height) in pixels.
            offset: of the sample inside its pixel, from the top-left corner.
            sample: its number, which turns the jitter.
        """
        arrays = {name: entry.arrays for name, entry in baked.items()}
        motion = motion_of(state.motion, state.course)
        now = self._animator.at(baked["surface"], baked["shell"], state.extrusion, motion, state.time)
        arrays |= {"surface": now.surface, "shell": now.shell}
        shell_key = (now.key, state.base.opaque)
        objects, place = self._shell(shell_key, now, baked["shell"], state)
        state = suited(state, place, arrays["texture"]["colour"].shape, size)
        then = texture_moment(state.texture, state.course, state.time, state.voxels.wrap == "repeat")
        state = thinned(state, then.opacity)
        texture_key, texture = self._texture(state, baked, then.words, place)
        values = self._light(state, arrays) | moved(state.camera, size, place.centre)
        angle, width = pixel(state, size)
        values |= {
            "pixel_angle": angle,
            "pixel_side": width,
            "picture_size": size,
            "pixel_offset": offset,
            "sample_shift": float(sample),
            "texture_slide": then.slide,
            "buffer_white": state.accumulation.white_radiance(),
            "start_tet": holding(arrays["shell"], place, state.camera),
            "matter_scale": texture.scale * state.voxels.density,
            "reference_length": reference_length(arrays["texture"], state.extrusion.thickness),
            "normal_coding": texture.coding,
            "filter_coarsest": float(texture.levels),
            "shell_size": tuple(float(side) for side in arrays["texture"]["size"]),
            **uniforms(state.voxels, "voxels"),
            **uniforms(state.base, "base"),
            **picture_values(state.picture, place.centre),
        }
        for slot, technique in state.techniques().items():
            values |= uniforms(technique, slot) | technique.constants(state, arrays)
        textures: dict[str, AnyTexture] = {
            "shell_tets": objects["shell_tets"],
            "shell_base": objects["shell_base"],
            **_samplers(texture),
            **self._sky_view(state, baked),
            **self._tables_of(state, baked),
            **self._picture(state, baked),
        }
        shown = (texture_key, then.slide)
        frame = Frame(self, state, arrays, shell_key, shown, place, size, offset, sample, textures, values)
        if "things" in baked:
            frame.things = self._things.find(baked["things"], state.things, place)
            frame.take(*frame.things.from_sun(direction(state.sun), state.things.resolution))
        frame.take(*state.shadow.look(frame))
        prepared: Prepared = state.order.picture(frame)
        return prepared

    def draw(self, prepared: Prepared) -> None:
        """Put a prepared sample before the background, into the bound framebuffer."""
        run_fullscreen(self._gl, *prepared)

    def release(self) -> None:
        """Free everything."""
        self._sky.release()
        self._tables.release()
        self.entries.release()
        self.rasters.release()
        self._things.release()
        if self._following is not None:
            self._following.release()
            self._following = None
        while self._shells:
            _free(self._shells.popitem()[1][0])
        while self._textures:
            self._textures.popitem()[1].release()

    def triangles(self, shell_key: Hashable) -> Triangles:
        """Those of a shell's boundary."""
        followed = self._following if shell_key not in self._shells else None
        found: Triangles = (followed.objects if followed else self._shells[shell_key][0])["entries"]
        return found

    def _shell(
        self, key: Hashable, now: Moment, rest: BakedArrays, state: ShellsState
    ) -> tuple[dict[str, Any], Placed]:
        hollow = not state.base.opaque or int(rest.arrays["counts"][0]) > 0
        if now.key != rest.key:
            return self._follow(now, rest, hollow)
        if key not in self._shells:
            place = placed(rest.arrays)
            self._shells[key] = shell_objects(self._gl, rest.arrays, place, hollow), place
            while len(self._shells) > SHELLS_KEPT:
                _free(self._shells.popitem(last=False)[1][0])
        self._shells.move_to_end(key)
        return self._shells[key]

    def _follow(self, now: Moment, rest: BakedArrays, hollow: bool) -> tuple[dict[str, Any], Placed]:
        """The objects of a moving shell; one is followed at a time, as the animator does."""
        key = (rest.key, hollow)
        if self._following is None or self._following.key != key:
            if self._following is not None:
                self._following.release()
            self._following = Following(self._gl, key, rest.arrays, hollow)
        return self._following.at(now)

    def _texture(
        self, state: ShellsState, baked: Baked, moment: Mapping[str, float], place: Placed
    ) -> tuple[Hashable, Uploaded]:
        thickness = state.extrusion.thickness
        filtered = getattr(state.filter, "levels", "")
        reading = (state.voxels.interpolation, state.voxels.wrap, state.voxels.storage)
        shape = baked["texture"].arrays["colour"].shape
        wide = sides(place, shape) if filtered == "directional" else (0.0, 0.0)
        key = (baked["texture"].key, tuple(moment.items()), thickness, reading, filtered, wide, "strides" in baked)
        if key not in self._textures:
            strides = baked["strides"].arrays if "strides" in baked else None
            made = texture_of(baked["texture"].arrays, thickness, **moment)
            self._textures[key] = upload(self._gl, made, state.voxels, thickness, filtered, wide, strides)
            while len(self._textures) > TEXTURES_KEPT:
                self._textures.popitem(last=False)[1].release()
        self._textures.move_to_end(key)
        return key, self._textures[key]

    def _light(self, state: ShellsState, arrays: Mapping[str, Arrays]) -> dict[str, Any]:
        now, sun = sky_for(arrays["sky"], angles(state.sun)[1]), direction(state.sun)
        return {
            "sun_direction": sun,
            "sun_irradiance": now.sun_irradiance,
            "sky_irradiance": now.sky_irradiance,
            **sky_uniforms(now, sun),
        }

    def _picture(self, state: ShellsState, baked: Baked) -> dict[str, AnyTexture]:
        """What is painted on the surface."""
        if "picture" not in baked:
            return {}
        found, globe = baked["picture"], laid_by(state.picture, True) == "globe"
        make = functools.partial(_painted, self._gl, found.arrays["picture"], globe)
        return dict(self._tables.get((found.key, globe), make))  # type: ignore[arg-type]

    def _tables_of(self, state: ShellsState, baked: Baked) -> dict[str, AnyTexture]:
        """Tables that techniques read."""
        found: dict[str, AnyTexture] = {}
        for slot, technique in state.techniques().items():
            for sampler, (name, array) in technique.tables.items():
                key = baked[name].key, array, state.voxels.wrap
                make = functools.partial(_table, self._gl, baked[name].arrays[array], state.voxels.wrap)
                found[f"{slot}_{sampler}"] = self._tables.get(key, make)["table"]  # type: ignore[assignment]
        return found

    def _sky_view(self, state: ShellsState, baked: Baked) -> dict[str, AnyTexture]:
        elevation = angles(state.sun)[1]

        def make() -> dict[str, AnyTexture]:
            return {"sky_view": self._gl.texture2d(sky_for(baked["sky"].arrays, elevation).view)}

        return dict(self._sky.get((baked["sky"].key, elevation), make))  # type: ignore[arg-type]


def _table(gl: GL, values: np.ndarray, side: Wrap) -> Mapping[str, AnyTexture]:
    return {"table": gl.texture3d(values, "linear", (side, side, "clamp"))}


def thinned(state: ShellsState, opacity: float) -> ShellsState:
    """A state whose matter has some times the extinction."""
    if opacity == 1.0:
        return state
    voxels = state.voxels.model_copy(update={"density": state.voxels.density * opacity})
    return state.model_copy(update={"voxels": voxels})


def _samplers(texture: Uploaded) -> dict[str, AnyTexture]:
    found: dict[str, AnyTexture] = {"shell_matter": texture.matter, "shell_normal": texture.normal}
    beside = {"filter_beside": texture.beside, "shell_coded": texture.coded}
    return found | {name: made for name, made in beside.items() if made is not None}


def _painted(gl: GL, picture: np.ndarray, globe: bool) -> Mapping[str, AnyTexture]:
    finest, *coarser = halves(picture)
    texture = gl.texture2d(finest, "linear", "repeat", coarser)
    texture.repeat_y = not globe  # it ends at the poles
    return {"base_picture": texture}


def holding(shell: Arrays, place: Placed, camera: Any) -> int:
    """Number of the tetrahedron that holds the camera, or -1."""
    if isinstance(camera, Orthographic):
        return -1
    eye = pose(camera).eye
    if np.linalg.norm(eye - place.centre) > place.radius:
        return -1
    inside = (shell["planes"][..., :3] @ eye + shell["planes"][..., 3] <= 0).all(axis=1)
    return int(np.argmax(inside)) if inside.any() else -1


def _free(objects: dict[str, Any]) -> None:
    for held in objects.values():
        held.release()
