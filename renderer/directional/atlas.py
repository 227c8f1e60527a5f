"""Pictures of points and of their light: drawn once, and kept while nothing moves."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import moderngl
import numpy as np

from renderer.directional.tiles import Tiles
from renderer.gl.context import GL
from renderer.gl.layers import check_drawable
from renderer.gl.program import AnyTexture
from renderer.gl.source import Source
from renderer.gl.targets import run_covered, run_fullscreen


class Atlas:
    """Which points are seen, and what they send to the eye: as strips of faces, or as pixels of the picture.

    Args:
        gl: the context's objects. size: (width, height) in texels. count: points that a texel takes.
        tiled: whether only blocks of pixels are looked at that may show a point.

    Raises:
        LimitError: larger than the machine can draw.
    """

    def __init__(self, gl: GL, size: tuple[int, int], count: int, tiled: bool) -> None:
        check_drawable(gl, *size)
        self._gl = gl
        self.size, self.count = size, count
        ctx = gl.ctx
        self._points = ctx.texture(size, count, dtype="u4")
        self._weights = ctx.texture(size, 4, dtype="f2") if count > 1 else None
        self._depth = ctx.depth_texture(size)
        self.shaded = ctx.texture(size, 4, dtype="f4")
        kinds: Sequence[moderngl.Texture] = [self._points] if self._weights is None else [self._points, self._weights]
        for texture in (*kinds, self.shaded):
            texture.filter = moderngl.NEAREST, moderngl.NEAREST
            texture.repeat_x = texture.repeat_y = False
        self._choosing = ctx.framebuffer(list(kinds), self._depth)
        self._shading = ctx.framebuffer([self.shaded], self._depth)
        self._shading.depth_mask = False
        self._tiles = Tiles(gl, size) if tiled else None
        self._chosen: Any = None
        self._lit: Any = None

    def choose(
        self, key: Any, source: Source, textures: Mapping[str, AnyTexture], values: Mapping[str, Any],
        bounds: Callable[[], np.ndarray],
    ) -> None:
        """Find which points are seen, unless they are those of `key` already.

        Args:
            bounds: gives those of the blocks of pixels (`renderer.directional.tiles`), where they are asked for.
        """
        if key == self._chosen:
            return
        self._chosen = self._lit = None
        self._shading.depth_mask = True
        self._shading.clear(0.0, 0.0, 0.0, 0.0, depth=1.0)
        self._shading.depth_mask = False
        self._choosing.use()
        if self._tiles is None:
            run_fullscreen(self._gl, source, textures, values, writes_depth=True)
        else:
            self._tiles.hold(bounds())
            self._tiles.draw(source, textures, values)
        self._chosen = key

    def light(self, key: Any, source: Source, textures: Mapping[str, AnyTexture], values: Mapping[str, Any]) -> None:
        """Light the points that are seen, unless they are lit as `key` says already."""
        whole = (self._chosen, key)
        if whole == self._lit:
            return
        self._lit = None
        chosen: dict[str, AnyTexture] = {"chosen_points": self._points}
        if self._weights is not None:
            chosen["chosen_weights"] = self._weights
        self._shading.use()
        run_covered(self._gl, source, {**textures, **chosen}, values)
        self._lit = whole

    def chosen_points(self) -> np.ndarray:
        """(height, width, count) numbers of the points that are seen, 0xFFFFFFFF where there is none, rows from the
        bottom of the picture or along a face's v."""
        self._gl.finish()
        width, height = self.size
        points = np.frombuffer(self._points.read(alignment=1), np.uint32).reshape(height, width, self.count)
        depth = np.frombuffer(self._depth.read(alignment=1), np.float32).reshape(height, width, 1)
        return np.where(depth < 1, points, np.uint32(0xFFFFFFFF))

    def chosen_weights(self) -> np.ndarray:
        """(height, width, count) what each of them weighs, rows likewise."""
        if self._weights is None:
            return np.ones((self.size[1], self.size[0], 1), np.float16)
        self._gl.finish()
        weights = np.frombuffer(self._weights.read(alignment=1), np.float16)
        return weights.reshape(self.size[1], self.size[0], self.count)

    def release(self) -> None:
        """Free everything."""
        if self._tiles is not None:
            self._tiles.release()
        self._choosing.release()
        self._shading.release()
        for texture in (self._points, self._depth, self.shaded, *([self._weights] if self._weights else [])):
            texture.release()
