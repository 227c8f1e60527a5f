"""One sample of a picture under way: what its passes share."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from renderer.core.technique import Arrays
from renderer.gl.layers import Kind
from renderer.gl.program import AnyTexture
from renderer.gl.source import Source
from renderer.shells.entries import Layers, View
from renderer.shells.lattice import Lattice
from renderer.shells.program import variant_of
from renderer.shells.resident import Placed
from renderer.world.camera import Orthographic, camera_uniforms, pose
from renderer.world.projection import view_projection
from renderer.world.sun import direction

if TYPE_CHECKING:
    from renderer.shells.renderer import ShellsRenderer
    from renderer.shells.state import ShellsState
    from renderer.shells.thing_mesh import ThingMesh

FAR = 1.0e30
"""What a picture from the sun holds where its rays meet nothing, as far away as can be."""

DEPTHS = 1e-4
"""Nearest distance that is drawn over the farthest, at least: a depth of 24 bits tells less apart."""


@dataclass
class Frame:
    """A sample under way.

    Attributes:
        renderer: its stores. state: the document. arrays: of its bakes, by name.
        shell_key, texture_key: of what is drawn.
        place: where the shell stands. size, offset, sample: of the picture, as `SceneRenderer.prepare` has them.
        textures, values: samplers and uniforms that every pass may read.
        things: other meshes of the scene, where there are any.
        lattice: where the rays are that it draws; None where each pixel has its own.
    """

    renderer: ShellsRenderer
    state: ShellsState
    arrays: Mapping[str, Arrays]
    shell_key: Any
    texture_key: Any
    place: Placed
    size: tuple[int, int]
    offset: tuple[float, float]
    sample: int
    textures: dict[str, AnyTexture]
    values: dict[str, Any]
    things: ThingMesh | None = None
    lattice: Lattice | None = None

    def take(self, textures: Mapping[str, AnyTexture], values: Mapping[str, Any]) -> None:
        """Let every later pass read these samplers and uniforms."""
        self.textures |= textures
        self.values |= values

    def matrix(self) -> np.ndarray:
        """Of the camera, over all that is drawn."""
        camera, near_far = self.state.camera, reach(self.state.camera, self.place)
        if self.things is not None:
            other = reach(camera, self.things.place)
            farthest = max(near_far[1], other[1])
            near_far = max(min(near_far[0], other[0]), DEPTHS * farthest), farthest
        if self.lattice is not None:
            return self.lattice.projection(self._whole(camera, self.lattice, near_far))
        return view_projection(camera, self.size, self.offset, self.place.centre, near_far)

    def sparser(self, lattice: Lattice, state: ShellsState) -> Frame:
        """The same with fewer rays, of a state that differs from this one's in how they are followed."""
        values, textures = {**self.values, **lattice.uniforms(self.values)}, dict(self.textures)
        return replace(self, state=state, size=lattice.size, values=values, textures=textures, lattice=lattice)

    def entries(self) -> Layers:
        """Where the camera's rays come into the shell, layer by layer."""
        key = (self.shell_key, self.state.camera, self.offset, variant_of(self.state).opaque, self.lattice)
        return self._entries(key, self.state.camera, self.size, self.offset)

    def from_sun(
        self, name: str, resolution: int, kinds: Mapping[str, Kind], source: Callable[[ShellsState], Source]
    ) -> tuple[dict[str, AnyTexture], dict[str, Any]]:
        """A picture of the whole shell seen from the sun, unless it is still there.

        Its rays read the texture at the camera's level, where that is coarser than their own, or the light would
        belong to other matter than what is seen.

        Args:
            name: of the picture. resolution: its side in texels.
            kinds: components and type of each of its textures, by name; all `FAR` where there is nothing.
            source: makes its fragment stage.

        Returns:
            `shadow_<name>` textures, and the uniforms by which a place finds its texel.
        """
        camera = sun_camera(self.place, direction(self.state.sun))
        size = (resolution, resolution)
        seen = sun_values(camera, self.place, resolution)
        values = {**self.values, **seen, "picture_size": size, "pixel_offset": (0.5, 0.5)}
        values |= {"pixel_angle": 0.0, "pixel_side": max(camera.width / resolution, self._pixel())}
        layers = self._entries(("sun", self.shell_key, camera), camera, size, (0.5, 0.5))
        reading = (self.texture_key, self.state.voxels, self.state.filter, variant_of(self.state))
        drawn = (name, values["pixel_side"], *reading)
        made = layers.draw(tuple(kinds.values()), FAR, source(self.state), self.textures, values, drawn)
        textures: dict[str, AnyTexture] = {f"shadow_{part}": texture for part, texture in zip(kinds, made, strict=True)}
        return textures, {key: value for key, value in seen.items() if key.startswith("shadow_")}

    def _pixel(self) -> float:
        """Width of the camera's pixels in the middle of the shell [m], in steps of a quarter of a level."""
        away = float(np.linalg.norm(pose(self.state.camera).eye - self.place.centre))
        width = self.values["pixel_side"] + self.values["pixel_angle"] * away
        return float(2 ** (round(4 * math.log2(max(width, 1e-9))) / 4))

    def _entries(self, key: Any, camera: Any, size: tuple[int, int], offset: tuple[float, float]) -> Layers:
        near_far, lattice = reach(camera, self.place), self.lattice if camera is self.state.camera else None
        triangles = self.renderer.triangles(self.shell_key)
        if lattice is None:
            matrix = view_projection(camera, size, offset, self.place.centre, near_far)
            return self.renderer.entries.find(View(key, size, triangles, matrix))
        whole = self._whole(camera, lattice, near_far)
        view = View(key, size, triangles, lattice.projection(whole), lattice.sides(whole))
        return self.renderer.entries.find(view)

    def _whole(self, camera: Any, lattice: Lattice, near_far: tuple[float, float]) -> np.ndarray:
        return view_projection(camera, lattice.picture, (0.5, 0.5), self.place.centre, near_far)


def reach(camera: Any, place: Placed) -> tuple[float, float]:
    """Nearest and farthest distance ahead of a camera between which the shell lies [m]."""
    at = pose(camera)
    middle = float((place.centre - at.eye) @ at.forward)
    return max(middle - place.radius, 1e-3 * place.radius), max(middle + place.radius, 2e-3 * place.radius)


def moved(camera: Any, size: tuple[int, int], centre: np.ndarray) -> dict[str, Any]:
    """The camera's uniforms, counted from the middle of the shell."""
    values: dict[str, Any] = dict(camera_uniforms(camera, *size))
    values["camera_origin"] = tuple(np.asarray(values["camera_origin"]) - centre)
    return values


def sun_camera(place: Placed, sun: np.ndarray) -> Orthographic:
    """A parallel view along the sun's rays that just holds the shell."""
    up = (0.0, 1.0, 0.0) if abs(sun[2]) > 0.9 else (0.0, 0.0, 1.0)
    return Orthographic(
        centre=tuple(float(v) for v in place.centre),
        direction=tuple(-float(v) for v in sun),
        up=up,
        width=2.02 * place.radius,
    )


def sun_values(camera: Orthographic, place: Placed, resolution: int) -> dict[str, Any]:
    """Uniforms of the sun's view: its rays, and how a place finds its texel."""
    values = moved(camera, (resolution, resolution), place.centre)
    # from just before the shell: distances are short, and keep their digits
    ahead = reach(camera, place)[0] * np.asarray(values["camera_corner"])
    values["camera_origin"] = tuple(np.asarray(values["camera_origin"]) + ahead)
    texel = camera.width / resolution
    across, down = (np.asarray(values[f"camera_origin_d{axis}"]) / texel**2 for axis in "xy")
    return values | {
        "shadow_origin": values["camera_origin"],
        "shadow_across": tuple(across),
        "shadow_down": tuple(down),
        "shadow_along": values["camera_corner"],
        "shadow_texel": texel,
        "shadow_side": float(resolution),
        "start_tet": -1,
    }
