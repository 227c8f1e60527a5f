"""Draws the clouds on the GL thread."""

from __future__ import annotations

import functools
from collections.abc import Callable, Hashable, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

import moderngl
import numpy as np

from renderer.clouds.frame_passes import Pass, layer_source, lit_passes
from renderer.clouds.frame_values import (
    air_frame,
    cloud_side,
    excess,
    moves,
    pixel_angle,
    shows_disc,
    variant_of,
    world_values,
)
from renderer.clouds.moving_map import field_texture, moving_map
from renderer.clouds.program import (
    AIR_AROUND,
    AIR_ROWS,
    AIR_SLICES,
    LAND_BLOCK,
    Variant,
    air_source,
    ground_source,
    scout_source,
)
from renderer.clouds.textures import (
    LIT_TOPS,
    horizon_texture,
    moment_map,
    technique_textures,
    weather_texture,
    world_textures,
)
from renderer.core.params import uniforms
from renderer.core.technique import Arrays, BakedArrays
from renderer.gl.context import GL
from renderer.gl.layers import Kind, Layers, LayerStore
from renderer.gl.parts import run_parts
from renderer.gl.program import AnyTexture
from renderer.gl.resident import Resident
from renderer.gl.targets import run_fullscreen
from renderer.world.camera import camera_uniforms
from renderer.world.sun import angles

if TYPE_CHECKING:
    from renderer.clouds.state import CloudsState

Baked = Mapping[str, BakedArrays]
Awaited = tuple[Hashable, str, Callable[[], dict[str, np.ndarray]]]
"""A key of what a technique's frame needs, the slot, and how to have it."""

Prepared = tuple[list[Pass], dict[str, AnyTexture], dict[str, Any]]

GROUND_LAYERS: dict[str, Kind] = {"traced_ground": (4, "f4"), "traced_albedo": (4, "f2")}
"""What is traced of the ground, and how it is stored."""

LAYER_LAYERS: dict[str, Kind] = {
    "traced_first": (4, "f4"),
    "traced_second": (4, "f4"),
    "traced_slopes": (4, "f2"),
    "traced_look": (4, "nu2"),
    "traced_kept": (4, "f2"),
    "traced_past": (4, "f2"),
}
"""What is traced of the layer and of the air before and behind it."""

GROUNDS_KEPT, STRETCHES_KEPT = 32 << 20, 68 << 20
"""Bytes of traced samples kept, so that a moved sun only lights them again: four of 512 x 512."""

SCOUTS_KEPT = 1 << 20
"""Bytes kept of the scouted ground, which only the next trace reads."""

AIRS_KEPT = 8 << 20
"""Bytes kept of the air's tables: those of the last few cameras and suns."""

MOMENTS_KEPT = 128 << 20
"""Bytes kept of what suns and moments ask for."""


class CloudsRenderer:
    """Textures of what was baked, and the frames drawn with them; one serves every view of the process."""

    def __init__(self, gl: GL) -> None:
        self._gl = gl
        self._baked = Resident(gl, 24)
        self._moment = Resident(gl, 24, MOMENTS_KEPT)
        self._scouts = LayerStore(gl, ((1, "f4"),), SCOUTS_KEPT)
        self._grounds = LayerStore(gl, tuple(GROUND_LAYERS.values()), GROUNDS_KEPT)
        self._stretches = LayerStore(gl, tuple(LAYER_LAYERS.values()), STRETCHES_KEPT, depth=True)
        self._airs = LayerStore(gl, ((4, "f4"),), AIRS_KEPT)
        self._beside = ThreadPoolExecutor(1, "clouds")

    def prepare(
        self, state: CloudsState, baked: Baked, size: tuple[int, int], offset: tuple[float, float], sample: int
    ) -> Prepared:
        """Find the ground of one sample, unless it is still there, and gather what lights it.

        Args:
            state, baked: the document and what it needed baked.
            size: (width, height) in pixels.
            offset: of the sample inside its pixel, from the top-left corner.
            sample: its number.
        """
        arrays = {name: entry.arrays for name, entry in baked.items()}
        keys = tuple(sorted(entry.key for entry in baked.values()))
        awaited = self._begun(state, arrays, keys)
        values = world_values(state, arrays) | camera_uniforms(state.camera, *size)
        values |= air_frame(values["camera_origin"], state.planet.radius, values["sun_direction"])
        values |= {"camera_excess": excess(values["camera_origin"], state.planet.radius)}
        values |= {"picture_size": size, "pixel_offset": offset, "pixel_angle": pixel_angle(state, size)}
        textures = self._textures(state, baked, arrays, keys)
        for slot, technique in state.techniques().items():
            values |= uniforms(technique, slot) | technique.constants(state, arrays)
        variant = variant_of(state, values)
        textures |= self._air_tables(state, baked, variant, values, textures)
        textures |= self._traced(state, baked, (size, offset), variant, values, textures)
        for key, slot, made in awaited:
            textures |= self._moment.get(key, lambda slot=slot, made=made: technique_textures(self._gl, slot, made()))  # type: ignore[misc, arg-type]
        disc = variant.sky and shows_disc(values)
        return lit_passes(state, variant, disc), textures, values

    def _begun(self, state: CloudsState, arrays: Mapping[str, Arrays], keys: tuple[str, ...]) -> list[Awaited]:
        """What this sun and moment ask of the techniques, begun beside this thread unless it is still there."""
        found: list[Awaited] = []
        for slot, technique in state.techniques().items():
            key = (slot, technique.frame_key(state), keys)
            if key[1]:
                make = functools.partial(technique.frame_textures, state, arrays)
                found.append((key, slot, make if key in self._moment else self._beside.submit(make).result))
        return found

    def _traced(
        self,
        state: CloudsState,
        baked: Baked,
        sample: tuple[tuple[int, int], tuple[float, float]],
        variant: Variant,
        values: dict[str, Any],
        textures: Mapping[str, AnyTexture],
    ) -> dict[str, AnyTexture]:
        """The ground and the layer as one sample's rays meet them: the same for every sun."""
        ground_key = (state.camera, sample, state.planet, baked["land"].key)

        def draw_scout(layers: Layers) -> None:
            layers.use()
            run_fullscreen(self._gl, scout_source(variant), textures, values)

        def draw_ground(layers: Layers) -> None:
            blocks = tuple(-(-side // LAND_BLOCK) for side in sample[0])
            scout = self._scouts.get(ground_key, (blocks[0], blocks[1]), draw_scout)[0]
            layers.use()
            run_fullscreen(self._gl, ground_source(variant), {**textures, "traced_scout": scout}, values)

        found: dict[str, AnyTexture] = dict(
            zip(GROUND_LAYERS, self._grounds.get(ground_key, sample[0], draw_ground), strict=True)
        )
        moment = state.time if moves(state) or state.layer.wind > 0 else 0.0
        keys = (baked["fields"].key, baked["air"].key)
        layer_key = (ground_key, state.layer, state.clouds, moment, keys, state.geometry)

        def draw_layer(layers: Layers) -> None:
            layers.use()
            run_fullscreen(self._gl, layer_source(state, variant), {**textures, **found}, values, writes_depth=True)

        names = (*LAYER_LAYERS, "traced_depth")
        found |= zip(names, self._stretches.get(layer_key, sample[0], draw_layer), strict=True)
        return found

    def _air_tables(
        self,
        state: CloudsState,
        baked: Baked,
        variant: Variant,
        values: dict[str, Any],
        textures: Mapping[str, AnyTexture],
    ) -> dict[str, AnyTexture]:
        """The air as this camera's place and this sun show it."""
        if not variant.table:
            return {}
        place = (tuple(values["camera_origin"]), state.planet.radius, baked["air"].key)
        made: dict[str, AnyTexture] = {}
        for name, width, key in (
            ("air_light", AIR_AROUND * AIR_SLICES, (*place, angles(state.sun))),
            ("air_passed", AIR_SLICES, place),
        ):

            def draw(layers: Layers, name: str = name) -> None:
                layers.use()
                run_fullscreen(self._gl, air_source(variant, name == "air_light"), textures, values)

            made[name] = self._airs.get((name, key), (width, AIR_ROWS), draw)[0]
            made[name].filter = moderngl.LINEAR, moderngl.LINEAR
        return made

    def draw(self, prepared: Prepared) -> None:
        """Light a prepared sample: linear premultiplied radiance into the bound framebuffer."""
        passes, textures, values = prepared
        parts = [(part.source, part.where) for part in passes]
        run_parts(self._gl, parts, textures["traced_depth"], textures, values)  # type: ignore[arg-type]

    def release(self) -> None:
        """Free every texture."""
        self._beside.shutdown()
        self._baked.release()
        self._moment.release()
        self._scouts.release()
        self._grounds.release()
        self._stretches.release()
        self._airs.release()

    def _map(self, state: CloudsState, key: str, fields: Arrays) -> dict[str, AnyTexture]:
        """The moment's map: drawn where it is made of fields that turn into each other."""
        if state.clouds.kind != "procedural":
            return moment_map(self._gl, state.clouds, fields, cloud_side(state), state.time)
        held = self._baked.get(("moving", key), lambda: field_texture(self._gl, fields))
        return moving_map(self._gl, state.clouds, held, cloud_side(state), state.time)  # type: ignore[arg-type]

    def _textures(
        self, state: CloudsState, baked: Baked, arrays: Mapping[str, Arrays], keys: tuple[str, ...]
    ) -> dict[str, AnyTexture]:
        world = tuple(baked[name].key for name in ("air", "sky", "globe", "land", "fields"))
        held = dict(self._baked.get(world, lambda: world_textures(self._gl, arrays)))
        place = (state.planet.latitude, state.planet.longitude, state.planet.radius)
        held |= self._baked.get(
            ("weather", baked["fields"].key, place, state.layer.ends, state.layer.ends_azimuth),
            lambda: weather_texture(self._gl, arrays["fields"], state.planet, state.layer),
        )
        azimuth = angles(state.sun)[0] if arrays["land"]["top"] > 0 else 0.0
        tops = tuple(state.layer.base + share * state.layer.thickness for share in LIT_TOPS)
        held |= self._moment.get(
            ("horizon", baked["land"].key, azimuth, tops),
            lambda: horizon_texture(self._gl, arrays["land"], azimuth, tops),
        )
        fields = baked["fields"].key
        held |= self._moment.get(
            ("map", fields, state.clouds, state.time if moves(state) else 0.0),
            lambda: self._map(state, fields, arrays["fields"]),
        )
        for slot, technique in state.techniques().items():

            def kept(slot: str = slot, technique: Any = technique) -> dict[str, AnyTexture]:
                return technique_textures(self._gl, slot, technique.kept_textures(state, arrays))

            held |= self._baked.get((slot, technique, keys), kept)
        return held  # type: ignore[return-value]
