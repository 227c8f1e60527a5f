"""Draws the directional textures on the GL thread."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import moderngl
import numpy as np

from renderer.core.params import uniforms
from renderer.core.technique import Arrays, BakedArrays
from renderer.directional.atlas import Atlas
from renderer.directional.facing import directions_needed, faces_seen
from renderer.directional.hemisphere import hemisphere_of
from renderer.directional.points import code_texels, surfel_texels
from renderer.directional.program import Variant, draw_source, select_source, shade_source, variant_of
from renderer.directional.seen import Seen
from renderer.directional.technique import SHADOW_CODE
from renderer.directional.tiles import bounds
from renderer.gl.context import GL
from renderer.gl.program import AnyTexture
from renderer.gl.resident import Resident
from renderer.gl.source import Source
from renderer.gl.targets import Target, run_fullscreen
from renderer.world.camera import Orthographic, camera_uniforms, pose
from renderer.world.sky import sky_for, sky_uniforms
from renderer.world.sun import angles, direction

if TYPE_CHECKING:
    from renderer.directional.state import DirectionalState

Baked = Mapping[str, BakedArrays]
Prepared = tuple[Source, dict[str, AnyTexture], dict[str, Any]]

ROW = 1024
"""Points in a row of a picture of them all."""

POINTS_KEPT, SEEN_KEPT, ATLASES_KEPT = 4, 2, 6
"""Clouds, sets of faces and pictures of points that stay on the GPU."""


@dataclass(frozen=True)
class Chosen:
    """Which points a sample shows, before they are lit.

    Attributes:
        atlas: the points. variant: of the shaders. textures, values: what their stages read.
    """

    atlas: Atlas
    variant: Variant
    textures: dict[str, AnyTexture]
    values: dict[str, Any]


class DirectionalRenderer:
    """Points and what the faces see of them on the GPU; one serves every view of the process."""

    def __init__(self, gl: GL) -> None:
        self._gl = gl
        self._sky = Resident(gl, 8)
        self._points = Resident(gl, POINTS_KEPT)
        self._codes = Resident(gl, 2 * POINTS_KEPT)
        self._own = Resident(gl, 16)
        self._seen: OrderedDict[Hashable, Seen] = OrderedDict()
        self._atlases: OrderedDict[Hashable, Atlas] = OrderedDict()
        self.atlas: Atlas | None = None
        """What the last sample was drawn from."""

    def prepare(
        self, state: DirectionalState, baked: Baked, size: tuple[int, int], offset: tuple[float, float], sample: int
    ) -> Prepared:
        """Choose and light the points that a sample shows.

        Args:
            state, baked: the document and what it needed baked.
            size: (width, height) in pixels.
            offset: of the sample inside its pixel, from the top-left corner.
            sample: its number; nothing here is drawn by chance.
        """
        chosen = self.choose(state, baked, size, offset)
        atlas, variant, textures, values = chosen.atlas, chosen.variant, chosen.textures, chosen.values
        lights = (state.cloud.position_bits, *(entry.key for entry in baked.values()), state.sun, *state.lighting())
        sky = self._sky_view(state, baked)
        atlas.light(lights, shade_source(state, variant), {**textures, **sky}, values)
        linear = getattr(state.selection, "magnification", "nearest") == "linear"
        atlas.shaded.filter = (moderngl.LINEAR, moderngl.LINEAR) if linear else (moderngl.NEAREST, moderngl.NEAREST)
        self.atlas = atlas
        behind = {name: held for name, held in textures.items() if name == "light_environment"}
        return draw_source(variant), {**sky, **behind, "shaded": atlas.shaded}, values

    def choose(
        self, state: DirectionalState, baked: Baked, size: tuple[int, int], offset: tuple[float, float]
    ) -> Chosen:
        """Find the points that a sample shows; arguments as of `prepare`."""
        arrays = {name: entry.arrays for name, entry in baked.items()}
        box = np.asarray(arrays["visibility"]["box"], np.float64)
        faces = faces_seen(state.camera, box)
        textures, blocks = self._what_is_lit(state, baked, arrays)
        variant = variant_of(state, blocks, arrays)
        values = self._values(state, arrays, box, faces, size, offset)
        size_of = size if variant.per_pixel else (3 * variant.texels, variant.texels)
        atlas = self._atlas(size_of, variant.selection_count, variant.per_pixel)
        view = (state.camera, size, offset) if variant.per_pixel else (state.camera,)
        seen = self._layers(state, baked, arrays, box, faces)
        reach = (box[1] - box[0]).max() / state.visibility.texels
        atlas.choose(
            (baked["visibility"].key, state.cloud.position_bits, state.selection, view),
            select_source(state, variant),
            {**textures, **seen.textures},
            values,
            lambda: bounds(*seen.cells, reach, state.camera, box.mean(axis=0), size),
        )
        return Chosen(atlas, variant, textures, values)

    def lit(self, state: DirectionalState, baked: Baked) -> np.ndarray:
        """What each point in use sends to the eye, (N, 3) float32 W m-2 sr-1: the same as in any picture of it."""
        arrays = {name: entry.arrays for name, entry in baked.items()}
        box = np.asarray(arrays["visibility"]["box"], np.float64)
        textures, blocks = self._what_is_lit(state, baked, arrays)
        variant = replace(variant_of(state, blocks, arrays), selection_count=1)
        values = self._values(state, arrays, box, [], (1, 1), (0.5, 0.5))
        count = len(arrays["visibility"]["used"])
        numbers = np.minimum(np.arange(-(-count // ROW) * ROW, dtype=np.uint32), count - 1).reshape(-1, ROW, 1)
        points, target = self._gl.texture2d(numbers), Target(self._gl, ROW, len(numbers))
        try:
            target.use()
            shown = {**textures, **self._sky_view(state, baked), "chosen_points": points}
            run_fullscreen(self._gl, shade_source(state, variant), shown, values)
            return np.ascontiguousarray(target.read()[::-1].reshape(-1, 4)[:count, :3])
        finally:
            points.release()
            target.release()

    def draw(self, prepared: Prepared) -> None:
        """Put a prepared sample before the background, into the bound framebuffer."""
        run_fullscreen(self._gl, *prepared)

    def release(self) -> None:
        """Free everything."""
        for held in (self._sky, self._points, self._codes, self._own):
            held.release()
        for store in (self._seen, self._atlases):
            while store:
                store.popitem()[1].release()

    def _what_is_lit(
        self, state: DirectionalState, baked: Baked, arrays: Mapping[str, Arrays]
    ) -> tuple[dict[str, AnyTexture], int]:
        """Textures of points, codes and techniques, and the texels of a point's code."""
        used = arrays["visibility"]["used"]
        box = np.asarray(arrays["visibility"]["box"], np.float64)
        openness, bits = arrays["shadows"]["openness"], state.cloud.position_bits
        points = self._points.get(
            (baked["shadows"].key, bits),
            lambda: {"surfels": self._gl.texture2d(surfel_texels(arrays["cloud"], used, openness, box, bits))},
        )
        words = arrays[SHADOW_CODE]["words"] if SHADOW_CODE in arrays else np.zeros((1, 1), np.uint32)
        code = self._codes.get(
            baked[SHADOW_CODE].key if SHADOW_CODE in baked else None,
            lambda: {"shadow_code": self._gl.texture2d(code_texels(words), "nearest")},
        )
        found: dict[str, Any] = {**points, **code}
        keys = {name: entry.key for name, entry in baked.items()}
        for slot, technique in state.techniques().items():
            key = (slot, technique.kind, technique.textures_key(keys))
            made = self._own.get(key, _textures_of(technique, self._gl, arrays))
            # A sampler without a texture would read one of another type.
            found |= {f"{slot}_{name}": made.get(name, self._blank(kind)) for name, kind in technique.textures.items()}
        return found, -(-words.shape[1] // 4)

    def _blank(self, kind: str) -> Any:
        """A texel for a sampler that a technique has no use for."""
        dtype = np.uint32 if kind.startswith("u") else np.float32
        texel = np.zeros((1, 1, 4), dtype)
        return self._own.get(("blank", kind), lambda: {"blank": self._gl.texture2d(texel)})["blank"]

    def _layers(
        self, state: DirectionalState, baked: Baked, arrays: Mapping[str, Arrays], box: np.ndarray, faces: list[int]
    ) -> Seen:
        key, layout = baked["visibility"].key, hemisphere_of(state.visibility.directions)
        seen = _kept(
            self._seen,
            key,
            SEEN_KEPT,
            lambda: Seen(self._gl, arrays["visibility"], arrays["cloud"], state.visibility.texels, layout.count),
        )
        pairs = [(f, int(d)) for f in faces for d in directions_needed(state.camera, f, box, layout)]
        seen.hold(pairs or [(0, 0)])
        return seen

    def _atlas(self, size: tuple[int, int], count: int, tiled: bool) -> Atlas:
        return _kept(self._atlases, (size, count, tiled), ATLASES_KEPT, lambda: Atlas(self._gl, size, count, tiled))

    def _values(
        self,
        state: DirectionalState,
        arrays: Mapping[str, Arrays],
        box: np.ndarray,
        faces: list[int],
        size: tuple[int, int],
        offset: tuple[float, float],
    ) -> dict[str, Any]:
        now, sun = sky_for(arrays["sky"], angles(state.sun)[1]), direction(state.sun)
        centre, at = box.mean(axis=0), pose(state.camera)
        camera: dict[str, Any] = dict(camera_uniforms(state.camera, *size))
        camera["camera_origin"] = tuple(np.asarray(camera["camera_origin"]) - centre)
        strips = [faces.index(face) if face in faces else -1 for face in range(6)]
        values: dict[str, Any] = {
            **camera,
            **sky_uniforms(now, sun),
            "box_low": tuple(box[0] - centre),
            "box_high": tuple(box[1] - centre),
            "eye": tuple(at.eye - centre),
            "eye_direction": tuple(-at.forward),
            "eye_parallel": int(isinstance(state.camera, Orthographic)),
            "picture_size": size,
            "pixel_offset": offset,
            "strip_faces": np.array([*faces, -1, -1, -1][:3], np.int32)[:, None],
            "face_strips": np.array(strips, np.int32)[:, None],
            "sun_direction": sun,
            "sun_irradiance": now.sun_irradiance,
            "sky_irradiance": now.sky_irradiance,
            **uniforms(state.lamp, "lamp"),
        }
        for slot, technique in state.techniques().items():
            values |= uniforms(technique, slot) | technique.constants(state, arrays)
        return values

    def _sky_view(self, state: DirectionalState, baked: Baked) -> dict[str, AnyTexture]:
        elevation = angles(state.sun)[1]

        def make() -> dict[str, AnyTexture]:
            return {"sky_view": self._gl.texture2d(sky_for(baked["sky"].arrays, elevation).view)}

        return dict(self._sky.get((baked["sky"].key, elevation), make))  # type: ignore[arg-type]


def _textures_of(technique: Any, gl: GL, arrays: Mapping[str, Arrays]) -> Callable[[], dict[str, AnyTexture]]:
    return lambda: dict(technique.textures_of(gl, arrays))


def _kept(store: OrderedDict[Hashable, Any], key: Hashable, most: int, make: Callable[[], Any]) -> Any:
    """An object of a store by its key, made on first use; those of keys unasked for longest are freed."""
    if key not in store:
        store[key] = make()
        while len(store) > most:
            store.popitem(last=False)[1].release()
    store.move_to_end(key)
    return store[key]
