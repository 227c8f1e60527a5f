"""Textures that stay on the GPU while they are asked for: a bounded cache, least recently used first out."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable, Mapping

from renderer.gl.context import GL
from renderer.gl.layers import Layers
from renderer.gl.program import AnyTexture

Held = AnyTexture | Layers


class Resident:
    """GPU objects by what they were made from.

    Args:
        gl: the context's objects.
        limit: entries kept; what a frame asks for must fit in it.
    """

    def __init__(self, gl: GL, limit: int) -> None:
        self._limit = limit
        self._held: OrderedDict[Hashable, Mapping[str, Held]] = OrderedDict()
        gl.at_close(self)

    def get(self, key: Hashable, make: Callable[[], Mapping[str, Held]]) -> Mapping[str, Held]:
        """The objects of `key`, made on first use."""
        if key in self._held:
            self._held.move_to_end(key)
            return self._held[key]
        made = make()
        while len(self._held) >= self._limit:
            self._free(self._held.popitem(last=False)[1])
        self._held[key] = made
        return made

    def release(self) -> None:
        """Free everything."""
        while self._held:
            self._free(self._held.popitem()[1])

    def _free(self, objects: Mapping[str, Held]) -> None:
        for held in objects.values():
            held.release()
