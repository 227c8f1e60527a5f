"""Other meshes of the scene on the GPU: how the camera sees them, and what they leave of the sun."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Hashable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import moderngl
import numpy as np

from renderer.core.technique import BakedArrays
from renderer.gl.context import GL
from renderer.gl.program import AnyTexture, bind_textures, set_uniforms
from renderer.gl.source import Source, assemble, stage
from renderer.gl.targets import Target
from renderer.shells.frame import FAR, reach, sun_camera, sun_values
from renderer.shells.program import chosen, composed, variant_of
from renderer.shells.resident import Placed
from renderer.shells.things import Ground, PlacedThings, Things, placed_things, sphere_round
from renderer.world.mesh_normals import face_vectors
from renderer.world.projection import view_projection

if TYPE_CHECKING:
    from renderer.shells.frame import Frame
    from renderer.shells.state import ShellsState

MESHES_KEPT = 2
"""Sets of things that stay on the GPU: those of two pictures side by side."""

SIZES_KEPT = 2
"""Sizes of pictures of them that are kept: of a picture, and of its fewer rays."""

READ = ("3f 3f 3f 3f", "position", "smoothed", "facing", "albedo")

SEEN_BODY = """in vec3 thing_place;
in vec3 thing_smooth;
flat in vec3 thing_facing;
flat in vec3 thing_albedo;
layout(location = 0) out vec4 seen;
void main() {
    Ray ray = pixel_ray(gl_FragCoord.xy);
    float side = dot(thing_facing, ray.direction) > 0.0 ? -1.0 : 1.0; // both reflect alike
    bool sunlit = side * dot(thing_facing, sun_direction) > 0.0;
    // Lit a little before itself, where no texel's edge shades it (Holbert 2011, "Saying goodbye to shadow acne").
    vec3 before = thing_place + 1.5 * thing_texel * side * thing_facing;
    vec3 light = light_base(before, side * normalize(thing_smooth), sunlit, thing_albedo);
    seen = vec4(light, max(dot(thing_place - ray.origin, ray.direction), 1.0e-6));
}"""

MET_BODY = """in vec3 thing_place;
layout(location = 0) out vec4 seen;
void main() {
    Ray ray = pixel_ray(gl_FragCoord.xy);
    seen = vec4(vec3(0.0), max(dot(thing_place - ray.origin, ray.direction), 1.0e-6));
}"""

MAP_BODY = """in vec3 thing_place;
flat in vec3 thing_facing;
layout(location = 0) out vec4 map;
void main() {
    float fall = dot(thing_facing, thing_along);
    fall = abs(fall) > 0.02 ? fall : 0.02; // steeper ones look away from the sun, but for a hair
    vec2 slope = vec2(dot(thing_facing, thing_across), -dot(thing_facing, thing_down)) * thing_texel * thing_texel;
    map = vec4(dot(thing_place - thing_origin, thing_along), -slope / fall, 0.0);
}"""

MAP_DECLARATIONS = """uniform vec3 thing_origin;
uniform vec3 thing_across;
uniform vec3 thing_down;
uniform vec3 thing_along;
uniform float thing_texel;"""


class ThingMesh:
    """Things as they stand, and what was drawn of them last.

    Args:
        gl: the context's objects. things: models. placed: their triangles. place: where the shell stands.
        key: equal ones look the same from everywhere.
    """

    def __init__(self, gl: GL, things: Things, placed: PlacedThings, place: Placed, key: Hashable) -> None:
        self._gl = gl
        self.key = key
        middle, radius = sphere_round(placed.corners)
        self.place = replace(place, centre=middle, radius=radius)
        level = np.array([isinstance(thing, Ground) for thing in things.list])[placed.owner]
        # A square that all stands on need not be within the map: it casts no shadow but below itself.
        casting = placed.corners[~level]
        self._casters = sphere_round(casting) if len(casting) else (place.centre, place.radius)
        self._centre = place.centre
        self._count = 3 * len(placed.corners)
        self._buffer = gl.ctx.buffer(_packed(placed, place.centre))
        self._seen: dict[tuple[int, int], Target] = {}
        self._map: tuple[Hashable, Target, dict[str, Any]] | None = None

    def draw(self, fragment: Source, textures: Mapping[str, AnyTexture], values: Mapping[str, Any]) -> None:
        """Draw them into the bound framebuffer, as the pipeline's switches are set."""
        program = self._gl.programs.get(stage("shells/things.vert"), fragment)
        bind_textures(program, textures)
        set_uniforms(program, values)
        # A stage that reads less has fewer attributes: the compiler leaves the others out.
        kinds = " ".join("3f" if name in program else "12x" for name in READ[1:])
        read = [name for name in READ[1:] if name in program]
        array = self._gl.ctx.vertex_array(program, [(self._buffer, kinds, *read)])
        try:
            array.render(mode=moderngl.TRIANGLES)
        finally:
            array.release()

    def seen(self, frame: Frame) -> moderngl.Texture:
        """Light and distance [m] of what the camera sees of them, 0 where it sees none."""
        return self._look(frame, things_source(frame.state))

    def met(self, frame: Frame) -> moderngl.Texture:
        """Distance [m] alone, in the same place; it holds until things are seen or met again in that size."""
        return self._look(frame, met_source(frame.state))

    def _look(self, frame: Frame, source: Source) -> moderngl.Texture:
        if frame.size not in self._seen:
            while len(self._seen) >= SIZES_KEPT:
                self._seen.pop(next(iter(self._seen))).release()
            self._seen[frame.size] = Target(self._gl, *frame.size, depth=True)
        target = self._seen[frame.size] = self._seen.pop(frame.size)
        target.use()
        target.clear()
        self._gl.ctx.enable_only(moderngl.DEPTH_TEST)
        self.draw(source, frame.textures, {**frame.values, "view_projection": frame.matrix()})
        self._gl.ctx.enable_only(moderngl.NOTHING)
        return target.texture

    def from_sun(self, sun: np.ndarray, resolution: int) -> tuple[dict[str, AnyTexture], dict[str, Any]]:
        """The map of what they leave of the sun, unless it is still there, and how a place finds its texel."""
        key = (tuple(float(part) for part in sun), resolution)
        if self._map is None or self._map[0] != key:
            target = self._map[1] if self._map is not None else Target(self._gl, resolution, resolution, depth=True)
            target.resize(resolution, resolution)
            self._map = key, target, self._draw_map(target, sun, resolution)
        return {"thing_map": self._map[1].texture}, self._map[2]

    def release(self) -> None:
        """Free them."""
        self._buffer.release()
        while self._seen:
            self._seen.popitem()[1].release()
        if self._map is not None:
            self._map[1].release()

    def _draw_map(self, target: Target, sun: np.ndarray, resolution: int) -> dict[str, Any]:
        middle, radius = self._casters
        camera = sun_camera(replace(self.place, centre=middle, radius=radius), sun)
        seen = sun_values(camera, replace(self.place, centre=self._centre), resolution)
        values = {name.replace("shadow_", "thing_"): value for name, value in seen.items() if "shadow_" in name}
        size = (resolution, resolution)
        matrix = view_projection(camera, size, (0.5, 0.5), self._centre, reach(camera, self.place))
        target.framebuffer.clear(FAR, 0.0, 0.0, 0.0)
        target.use()
        self._gl.ctx.enable_only(moderngl.DEPTH_TEST)
        self.draw(_map_source(), {}, {**values, "view_projection": matrix})
        self._gl.ctx.enable_only(moderngl.NOTHING)
        return values


class ThingMeshes:
    """The things that were drawn last, the longest unasked given back first."""

    def __init__(self, gl: GL) -> None:
        self._gl = gl
        self._held: OrderedDict[Hashable, ThingMesh] = OrderedDict()

    def find(self, baked: BakedArrays, things: Things, place: Placed) -> ThingMesh:
        """Things of a document beside a shell."""
        alone = all(isinstance(thing, Ground) for thing in things.list)  # the shell is what their map is as wide as
        key = (baked.key, things.list, tuple(float(part) for part in place.centre), place.radius if alone else None)
        if key not in self._held:
            self._held[key] = ThingMesh(self._gl, things, placed_things(things, baked.arrays), place, key)
            while len(self._held) > MESHES_KEPT:
                self._held.popitem(last=False)[1].release()
        self._held.move_to_end(key)
        return self._held[key]

    def release(self) -> None:
        """Free them."""
        while self._held:
            self._held.popitem()[1].release()


def things_source(state: ShellsState) -> Source:
    """The fragment stage that lights things: by Lambert's law, where matter does not shine by itself."""
    from renderer.shells.light.lambert import Lambert

    lit = state if state.light.kind == "unlit" else state.model_copy(update={"light": Lambert()})
    return composed(chosen(lit, ("filter", "shadow", "light")), variant_of(state), (), SEEN_BODY)


def met_source(state: ShellsState) -> Source:
    """The fragment stage that tells how far away things are."""
    return composed((), variant_of(state), (), MET_BODY)


def _map_source() -> Source:
    return assemble([], declarations=MAP_DECLARATIONS, body=MAP_BODY)


def _packed(placed: PlacedThings, centre: np.ndarray) -> bytes:
    corners = placed.corners - centre
    count = len(corners)
    facing = face_vectors(corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3))
    facing /= np.maximum(np.linalg.norm(facing, axis=1, keepdims=True), 1e-300)
    data = np.empty((count, 3, 4, 3), np.float32)
    data[:, :, 0], data[:, :, 1] = corners, placed.normals
    data[:, :, 2], data[:, :, 3] = facing[:, None], placed.albedo[:, None]
    return data.tobytes()
