"""Textures that stay on the GPU while they are asked for: a bounded cache, least recently used first out."""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Callable, Hashable, Mapping

from renderer.gl.context import GL
from renderer.gl.layers import BYTES, Layers
from renderer.gl.program import AnyTexture

Held = AnyTexture | Layers


class Resident:
    """GPU objects by what they were made from.

    Args:
        gl: the context's objects.
        limit: entries kept; what a frame asks for must fit in it.
        bytes_kept: size of all entries together, likewise; the newest is kept whatever its size.
    """

    def __init__(self, gl: GL, limit: int, bytes_kept: float = math.inf) -> None:
        self._limit = limit
        self._bytes_kept = bytes_kept
        self._held: OrderedDict[Hashable, Mapping[str, Held]] = OrderedDict()
        self._sizes: dict[Hashable, int] = {}
        gl.at_close(self)

    def __contains__(self, key: Hashable) -> bool:
        return key in self._held

    def get(self, key: Hashable, make: Callable[[], Mapping[str, Held]]) -> Mapping[str, Held]:
        """The objects of `key`, made on first use."""
        if key in self._held:
            self._held.move_to_end(key)
            return self._held[key]
        made = make()
        self._held[key] = made
        self._sizes[key] = sum(bytes_of(held) for held in made.values())
        while len(self._held) > max(self._limit, 1) or (len(self._held) > 1 and self._bytes() > self._bytes_kept):
            self._free(*self._held.popitem(last=False))
        return made

    def release(self) -> None:
        """Free everything."""
        while self._held:
            self._free(*self._held.popitem())

    def _bytes(self) -> int:
        return sum(self._sizes.values())

    def _free(self, key: Hashable, objects: Mapping[str, Held]) -> None:
        del self._sizes[key]
        for held in objects.values():
            held.release()


def bytes_of(held: Held) -> int:
    """Size of the textures' finest levels."""
    textures = held.textures if isinstance(held, Layers) else [held]
    return sum(int(math.prod(one.size)) * one.components * BYTES[one.dtype] for one in textures)
