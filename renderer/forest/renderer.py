"""Draws the forest on the GL thread."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from renderer.core.params import uniforms
from renderer.core.technique import BakedArrays
from renderer.forest.bounds import bounds, stretch
from renderer.forest.first_look import FirstLook
from renderer.forest.pattern import tallest
from renderer.forest.program import SCOUT_BLOCKS, TRACE_SLOTS, pass_source, scout_source, shade_source, trace_source
from renderer.forest.technique import ForestTechnique
from renderer.forest.textures import (
    bilinear_cells,
    ground_textures,
    kept_textures,
    pattern_textures,
    technique_textures,
    tile_map,
)
from renderer.forest.world_scale import CANOPY_HEIGHT, CELL, FADE, NODES, REACH, TILE_SIDE, VOXEL
from renderer.gl.context import GL
from renderer.gl.layers import Layers, LayerStore
from renderer.gl.program import AnyTexture
from renderer.gl.resident import Resident
from renderer.gl.source import Source
from renderer.gl.targets import run_fullscreen
from renderer.world.camera import Orthographic, camera_uniforms
from renderer.world.sky import sky_for, sky_uniforms
from renderer.world.sun import angles, direction

if TYPE_CHECKING:
    from renderer.forest.state import ForestState, Macros
    from renderer.forest.technique import SunPass

Baked = Mapping[str, BakedArrays]
Prepared = tuple[Source, dict[str, AnyTexture], dict[str, Any]]

SCOUTS_KEPT = 1 << 20
"""Bytes of scouted distances kept for each size of block: the last few cameras'."""

TRACES_KEPT = 64 << 20
"""Bytes of traced samples kept: sixteen of 512 x 512, so that a moved sun only lights them again."""

MOMENTS_KEPT = 256 << 20
"""Bytes kept of what suns ask for. One frame asks for 200 MB at most: a Fourier opacity map of 2,048 texels a side."""


class ForestRenderer:
    """Textures of what was baked, and the frames drawn with them; one serves every view of the process."""

    def __init__(self, gl: GL) -> None:
        self._gl = gl
        self._baked = Resident(gl, 24)
        self._moment = Resident(gl, 24, MOMENTS_KEPT)
        self._scouts = {side: LayerStore(gl, ((1, "f4"),), SCOUTS_KEPT) for side in SCOUT_BLOCKS}
        self._traces = LayerStore(gl, ((2, "f4"), (4, "nu2")), TRACES_KEPT)
        self._first = FirstLook(gl)
        self._bounds: dict[tuple[str, str], dict[str, Any]] = {}

    def prepare(
        self, state: ForestState, baked: Baked, size: tuple[int, int], offset: tuple[float, float], sample: int
    ) -> Prepared:
        """Trace one sample and draw what looks from the sun, unless they are still there.

        Args:
            state, baked: the document and what it needed baked.
            size: (width, height) in pixels.
            offset: of the sample inside its pixel, from the top-left corner.
            sample: its number, which turns the jitter.
        """
        look = (0, 1) if sample else (state.shadow.first_look(), state.geometry.first_pitch())
        state = state if sample else state.first_sample()
        values = self._world(state, baked)
        textures: dict[str, AnyTexture] = self._world_textures(state, baked)
        for slot, technique in state.techniques().items():
            values |= uniforms(technique, slot) | technique.constants()
        values |= camera_uniforms(state.camera, *size) | self._pixel(state, size)
        values |= {"picture_size": size, "pixel_offset": offset, "sample_shift": float(sample), "ray_pitch": 1.0}
        values["sample_smoothed"] = float(look != (0, 1))
        textures["scout"] = self._scout(state, baked, size, values, textures)
        rays = (-(-size[0] // look[1]), -(-size[1] // look[1]))
        thrown = values | {"picture_size": rays, "ray_pitch": float(look[1])}
        traced = self._traced(state, baked, (rays, look[1], offset, sample), thrown, textures)
        thrown |= self._shadow_pass(state, baked, size, values, textures)
        self._technique_textures(state, baked, textures)
        held = {**textures, **self._sky(state, baked), **traced}
        if look != (0, 1):
            return *self._first.prepare(state, (max(look[0], 1), look[1]), rays, held, thrown), values
        return shade_source(state), held, thrown

    def draw(self, prepared: Prepared) -> None:
        """Light a prepared sample: linear premultiplied radiance into the bound framebuffer."""
        run_fullscreen(self._gl, *prepared)

    def release(self) -> None:
        """Free every texture."""
        self._baked.release()
        self._moment.release()
        self._traces.release()
        self._first.release()
        for store in self._scouts.values():
            store.release()

    def _world_textures(self, state: ForestState, baked: Baked) -> dict[str, AnyTexture]:
        ground, pattern = baked["terrain"], baked["pattern"]
        seed = state.ground.map_seed
        held = {
            **self._baked.get(ground.key, lambda: ground_textures(self._gl, ground.arrays)),
            **self._baked.get(
                ("tiles", seed), lambda: {"tiles": self._gl.texture2d(tile_map(seed), "nearest", "repeat")}
            ),
            **self._baked.get(pattern.key, lambda: pattern_textures(self._gl, pattern.arrays)),
        }
        return held  # type: ignore[return-value]

    def _world(self, state: ForestState, baked: Baked) -> dict[str, Any]:
        ground, pattern = baked["terrain"], baked["pattern"]
        if (ground.key, pattern.key) not in self._bounds:
            elevation = ground.arrays["elevation"]
            self._bounds[ground.key, pattern.key] = {
                "terrain_range": bilinear_cells(elevation)[1],
                **bounds(elevation, tallest(pattern.arrays["colour"]) * float(ground.arrays["growth"].max())),
                **stretch(ground.arrays["growth"]),
            }
        now = sky_for(baked["sky"].arrays, angles(state.sun)[1])
        sun = direction(state.sun)
        return {
            "terrain_cell": CELL,
            "terrain_nodes": float(NODES),
            "tile_side": TILE_SIDE,
            "voxel_size": VOXEL,
            "canopy_height": CANOPY_HEIGHT,
            "scene_reach": REACH,
            "scene_fade": FADE,
            "sun_direction": sun,
            "sun_elevation": angles(state.sun)[1],
            "sun_irradiance": now.sun_irradiance,
            "sky_irradiance": now.sky_irradiance,
            **self._bounds[ground.key, pattern.key],
            **sky_uniforms(now, sun),
            **uniforms(state.ground, "ground"),
        }

    def _sky(self, state: ForestState, baked: Baked) -> dict[str, AnyTexture]:
        sky, elevation = baked["sky"], angles(state.sun)[1]
        made = self._moment.get(
            ("sky", sky.key, elevation), lambda: {"sky_view": self._gl.texture2d(sky_for(sky.arrays, elevation).view)}
        )
        return dict(made)  # type: ignore[arg-type]

    def _technique_textures(self, state: ForestState, baked: Baked, textures: dict[str, AnyTexture]) -> None:
        arrays = {name: entry.arrays for name, entry in baked.items()}
        keys = tuple(sorted(entry.key for entry in baked.values()))
        for slot, technique in state.techniques().items():
            textures |= self._kept(slot, technique, state, baked)
            if technique.frame_key(state):
                made = self._moment.get(
                    (slot, technique.frame_key(state), keys),
                    lambda t=technique, s=slot: technique_textures(  # type: ignore[misc]
                        self._gl, s, t, t.frame_textures(state, arrays)
                    ),
                )
                textures |= made  # type: ignore[arg-type]

    def _kept(
        self, slot: str, technique: ForestTechnique, state: ForestState, baked: Baked
    ) -> Mapping[str, AnyTexture]:
        """The textures of a technique that last as long as what was baked."""
        if type(technique).kept_textures is ForestTechnique.kept_textures:
            return {}  # an entry without textures would push out another's, which takes long to send again
        arrays = {name: entry.arrays for name, entry in baked.items()}
        keys = tuple(sorted(entry.key for entry in baked.values()))
        key = (slot, technique.kind, keys)  # type: ignore[attr-defined]
        make = lambda: kept_textures(self._gl, slot, technique.kept_textures(state, arrays))  # noqa: E731
        return self._baked.get(key, make)  # type: ignore[return-value]

    def _shadow_pass(
        self,
        state: ForestState,
        baked: Baked,
        size: tuple[int, int],
        values: dict[str, Any],
        textures: dict[str, AnyTexture],
    ) -> dict[str, Any]:
        """Draw the passes that look from the sun, unless they are still the last ones; their uniforms."""
        arrays = {name: entry.arrays for name, entry in baked.items()}
        given: dict[str, Any] = {}
        for slot, technique in state.techniques().items():
            sun_pass = technique.sun_pass(state, arrays, size)
            if sun_pass is None:
                continue
            key = (
                slot,
                technique,
                angles(state.sun),
                tuple(sun_pass.uniforms.items()),
                state.ground.map_seed,
                baked["terrain"].key,
                baked["pattern"].key,
            )
            sampled = {name: texture for name, texture in textures.items() if not name.startswith(slot)}
            made = self._moment.get(
                key,
                lambda p=sun_pass, s=slot, t=sampled: {  # type: ignore[misc]
                    "drawn": self._draw_pass(s, p, values, t, state.macros)
                },
            )
            drawn = made["drawn"]
            assert isinstance(drawn, Layers)
            names = (f"{slot}_{name}" for name in sun_pass.targets)
            textures |= dict(zip(names, drawn.textures, strict=True))
            given |= sun_pass.uniforms
        return given

    def _scout(
        self,
        state: ForestState,
        baked: Baked,
        size: tuple[int, int],
        values: dict[str, Any],
        textures: dict[str, AnyTexture],
    ) -> AnyTexture:
        """Where the rays of each block of pixels begin; the same until the camera, the ground or the trees change."""
        key = (state.camera, size, baked["terrain"].key, baked["pattern"].key)
        found = dict(textures)
        for number, (side, store) in enumerate(self._scouts.items()):

            def draw(layers: Layers, number: int = number) -> None:
                layers.use()
                run_fullscreen(self._gl, scout_source(number), found, values)

            blocks = (-(-size[0] // side), -(-size[1] // side))
            found["scout"] = store.get(key, blocks, draw)[0]
        return found["scout"]

    def _traced(
        self,
        state: ForestState,
        baked: Baked,
        sample: tuple[tuple[int, int], int, tuple[float, float], int],
        values: dict[str, Any],
        textures: dict[str, AnyTexture],
    ) -> dict[str, AnyTexture]:
        """Where the rays of a sample look at the light; the same for every sun, so kept while only the sun moves."""
        key = (
            state.camera,
            sample,
            values["sample_smoothed"],
            state.ground.map_seed,
            tuple(state.techniques()[slot] for slot in TRACE_SLOTS),
            baked["terrain"].key,
            baked["pattern"].key,
        )

        def draw(layers: Layers) -> None:
            layers.use()
            run_fullscreen(self._gl, trace_source(state), textures, values)

        place, voxel = self._traces.get(key, sample[0], draw)
        return {"traced_place": place, "traced_voxel": voxel}

    def _draw_pass(
        self, slot: str, sun_pass: SunPass, values: dict[str, Any], textures: dict[str, AnyTexture], cover: Macros
    ) -> Layers:
        kinds = tuple(sun_pass.targets.values())
        layers = Layers(self._gl, sun_pass.resolution, sun_pass.resolution * sun_pass.layers, kinds)
        source = pass_source(slot, sun_pass.name, sun_pass.glsl, sun_pass.declarations, cover, len(kinds))
        layers.use()
        run_fullscreen(self._gl, source, textures, values | dict(sun_pass.uniforms))
        return layers

    @staticmethod
    def _pixel(state: ForestState, size: tuple[int, int]) -> dict[str, float]:
        """Width of a pixel, as an angle in perspective and as a length in a parallel view."""
        if isinstance(state.camera, Orthographic):
            return {"pixel_angle": 0.0, "pixel_width": state.camera.width / size[0]}
        return {"pixel_angle": 2 * math.tan(math.radians(state.camera.field_of_view) / 2) / size[1], "pixel_width": 0.0}
