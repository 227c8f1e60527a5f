"""Several textures of one size drawn at once, kept while they are asked for."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable, Sequence

import moderngl

from renderer.core.errors import LimitError
from renderer.gl.context import GL

Kind = tuple[int, str]
BYTES = {"f1": 1, "nu2": 2, "f2": 2, "f4": 4, "i4": 4, "u4": 4}
"""Bytes of a component by moderngl's name of its type."""


def check_drawable(gl: GL, width: int, height: int) -> None:
    """Refuse a size that cannot be drawn into.

    Raises:
        LimitError: larger than the machine can draw, or nothing.
    """
    allowed = min(int(gl.ctx.info["GL_MAX_TEXTURE_SIZE"]), *gl.ctx.info["GL_MAX_VIEWPORT_DIMS"])
    if not (1 <= width <= allowed and 1 <= height <= allowed):
        refused = f"a picture of {width} x {height} pixels cannot be drawn here"
        raise LimitError("size", refused, f"1 to {allowed} a side")


class Layers:
    """A framebuffer with several textures.

    Args:
        gl: the context's objects.
        width, height: size in pixels.
        kinds: number of components (1, 2 or 4) and moderngl's name of the component type of each texture.
        depth: whether a texture of depths stands behind them, as the last of `textures`.

    Raises:
        LimitError: larger than the machine can draw.
    """

    def __init__(self, gl: GL, width: int, height: int, kinds: Sequence[Kind], depth: bool = False) -> None:
        check_drawable(gl, width, height)
        self.size = (width, height)
        self.textures = [gl.ctx.texture((width, height), components, dtype=dtype) for components, dtype in kinds]
        for texture in self.textures:
            texture.filter = moderngl.NEAREST, moderngl.NEAREST
            texture.repeat_x = texture.repeat_y = False
        behind = gl.ctx.depth_texture((width, height)) if depth else None
        self._framebuffer = gl.ctx.framebuffer(list(self.textures), behind)
        self.textures += [behind] if behind is not None else []

    def use(self) -> None:
        """Draw into them from now on, over their whole area."""
        self._framebuffer.use()

    def release(self) -> None:
        """Free them."""
        self._framebuffer.release()
        for texture in self.textures:
            texture.release()


class LayerStore:
    """Drawn layers by what they show; those of the longest unasked key are drawn over.

    Args:
        gl: the context's objects.
        kinds, depth: as in `Layers`.
        bytes_kept: size of all layers together; one picture is kept whatever its size.
    """

    def __init__(self, gl: GL, kinds: Sequence[Kind], bytes_kept: int, depth: bool = False) -> None:
        self._gl = gl
        self._depth = depth
        self._kinds = tuple(kinds)
        self._bytes_kept = bytes_kept
        self._held: OrderedDict[Hashable, Layers] = OrderedDict()

    def get(self, key: Hashable, size: tuple[int, int], draw: Callable[[Layers], None]) -> list[moderngl.Texture]:
        """The textures of `key` at a size, drawn by `draw` unless they are still there."""
        whole = (key, size)
        if whole not in self._held:
            layers = self._room(size)
            try:
                draw(layers)
            except BaseException:
                layers.release()
                raise
            self._held[whole] = layers
        self._held.move_to_end(whole)
        return self._held[whole].textures

    def release(self) -> None:
        """Free everything."""
        while self._held:
            self._held.popitem()[1].release()

    def _room(self, size: tuple[int, int]) -> Layers:
        """Layers of a size: old ones, when keeping all would be too much."""
        spare: Layers | None = None
        while self._held and self._bytes() + self._bytes_of(size) > self._bytes_kept:
            if spare is not None:
                spare.release()
            spare = self._held.popitem(last=False)[1]
        if spare is not None and spare.size == size:
            return spare
        if spare is not None:
            spare.release()
        return Layers(self._gl, *size, self._kinds, self._depth)

    def _bytes(self) -> int:
        return sum(self._bytes_of(layers.size) for layers in self._held.values())

    def _bytes_of(self, size: tuple[int, int]) -> int:
        behind = 4 * self._depth
        return size[0] * size[1] * (behind + sum(components * BYTES[dtype] for components, dtype in self._kinds))
