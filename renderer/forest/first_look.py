"""The first sample of a picture: one look at the sun for a block of pixels, smoothed over what lies alike.

What it costs to follow the sun's ray from every pixel is paid by the samples that refine a picture, not by the one that
is shown while the sun moves; and that one is quieter than a sample which keeps one place of each ray. It is one of the
samples of the mean, so that its smoothing fades from the picture as they are added.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from renderer.forest.program import look_source, shade_source, smooth_source, spread_source
from renderer.gl.context import GL
from renderer.gl.layers import Layers
from renderer.gl.program import AnyTexture
from renderer.gl.source import Source
from renderer.gl.targets import run_fullscreen

if TYPE_CHECKING:
    from renderer.forest.state import ForestState

SIZES_KEPT = 2
"""Sizes of pictures whose targets are kept: two pictures side by side, drawn in turns."""


class FirstLook:
    """Targets of the first sample, and the passes that fill them; used on the GL thread only."""

    def __init__(self, gl: GL) -> None:
        self._gl = gl
        self._kept: dict[tuple[tuple[int, int], int], tuple[Layers, ...]] = {}

    def prepare(
        self,
        state: ForestState,
        look: tuple[int, int],
        size: tuple[int, int],
        textures: Mapping[str, AnyTexture],
        values: Mapping[str, Any],
    ) -> tuple[Source, dict[str, AnyTexture]]:
        """Look for the sun and light a sample; what lays it into the bound framebuffer, with the values of its pixels.

        Args:
            state: of the first sample.
            look: pixels of a block's side that share a look at the sun, 1 where the shadow technique answers at each;
                and how many share a ray.
            size: (width, height) of the rays that were traced.
            textures, values: of the frame, with what was traced.
        """
        side, pitch = look
        looked, lit, smooth = self._targets(size, side)
        found = dict(textures)
        if side > 1:
            looked.use()
            run_fullscreen(self._gl, look_source(state, side), textures, values)
            found["looked"] = looked.textures[0]
        lit.use()
        run_fullscreen(self._gl, shade_source(state, side), found, values)
        held = {**textures, "lit": lit.textures[0]}
        if pitch == 1:
            return smooth_source(state, side), held
        smooth.use()
        run_fullscreen(self._gl, smooth_source(state, side), held, values)
        return spread_source(state, side), {**textures, "smooth_lit": smooth.textures[0]}

    def release(self) -> None:
        """Free every target."""
        while self._kept:
            for layers in self._kept.popitem()[1]:
                layers.release()

    def _targets(self, size: tuple[int, int], side: int) -> tuple[Layers, ...]:
        """What was looked for, lit and smoothed."""
        key = (size, side)
        if key not in self._kept:
            while len(self._kept) >= SIZES_KEPT:
                for layers in self._kept.pop(next(iter(self._kept))):
                    layers.release()
            blocks = (-(-size[0] // side), -(-size[1] // side))
            self._kept[key] = tuple(Layers(self._gl, *each, ((4, "f4"),)) for each in (blocks, size, size))
        self._kept[key] = self._kept.pop(key)
        return self._kept[key]
