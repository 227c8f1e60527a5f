"""One OpenGL thread for the shells' tests, and pictures of blocks of matter made for them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np
import pytest

from renderer.core.baking import bake_key, bake_now
from renderer.core.cache import Cache
from renderer.core.params import validate
from renderer.core.technique import BakedArrays
from renderer.gl.context import GL
from renderer.gl.targets import Target
from renderer.gl.thread import GLThread
from renderer.shells.bakes import bakes
from renderer.shells.renderer import ShellsRenderer
from renderer.shells.state import ShellsState
from renderer.shells.texture.strides import bake_strides

Draw = Callable[..., np.ndarray]

PLAIN: dict[str, Any] = {
    "scene": "shells",
    "surface": {"kind": "plane", "size": 2.0},
    "extrusion": {"thickness": 0.5},
    "camera": {"kind": "orthographic", "centre": [0, 0, 0], "direction": [0, 0, -1], "up": [0, 1, 0], "width": 1.6},
    "view": {"background": "none"},
    "base": {"opaque": False},
    "voxels": {"interpolation": "extinction", "storage": "float"},
    "light": {"kind": "unlit"},
    "shadow": {"kind": "none"},
    "filter": {"kind": "none"},
    "sampling": {"kind": "adaptive", "rate": 1.0, "jitter": 0.0, "most": 256},
}
"""A level square of 2 m under a shell of half a metre, seen from above; matter shines by itself."""


@pytest.fixture(scope="session")
def thread() -> Iterator[GLThread]:
    """A running OpenGL thread, closed without a leak after the shells' tests."""
    with GLThread("shells-tests") as running:
        yield running


@pytest.fixture(scope="session")
def draw(thread: GLThread) -> Draw:
    """Draws one sample at the pixels' centres: `draw(patch, colour, normal, reference_length, size, shell)`; or the
    mean of several, with other jitter each."""
    cache = Cache()

    def drawn(
        patch: Mapping[str, Any],
        colour: np.ndarray,
        normal: np.ndarray | None = None,
        reference_length: float = 0.1,
        size: int = 8,
        shell: Mapping[str, np.ndarray] | None = None,
        samples: int = 1,
    ) -> np.ndarray:
        state = validate(ShellsState, {**PLAIN, **patch})
        arrays = {bake.name: BakedArrays(bake_key(bake), bake_now(bake, cache)) for bake in bakes(state)}
        texture = {
            "colour": np.asarray(colour, np.float32),
            "normal": np.zeros((*colour.shape[:3], 4), np.float32) if normal is None else normal.astype(np.float32),
            "material": np.ones(colour.shape[:3], np.uint8),
            "size": np.ones(3),
            "reference_length": np.array(reference_length),
        }
        arrays["texture"] = BakedArrays("given", texture)
        if "strides" in arrays:
            strides = bake_strides({"wrap": state.voxels.wrap}, {"texture": texture}, lambda share, words: None)
            arrays["strides"] = BakedArrays("given strides", strides)
        if shell is not None:
            arrays["shell"] = BakedArrays("given shell", shell)
        return thread.call(_picture, state, arrays, size, samples)

    return drawn


def _picture(gl: GL, state: ShellsState, baked: Mapping[str, BakedArrays], size: int, samples: int) -> np.ndarray:
    renderer, target = ShellsRenderer(gl), Target(gl, size, size)
    try:
        total = np.zeros((size, size, 4), np.float32)
        for sample in range(samples):
            prepared = renderer.prepare(state, baked, (size, size), (0.5, 0.5), sample)
            target.use()
            renderer.draw(prepared)
            total += target.read()
        return total / np.float32(samples)
    finally:
        renderer.release()
        target.release()


def even(alpha: float, colour: tuple[float, float, float] = (1.0, 1.0, 1.0), layers: int = 4) -> np.ndarray:
    """A block of one colour and opacity, (layers, 4, 4, 4)."""
    block = np.empty((layers, 4, 4, 4), np.float32)
    block[:] = (*colour, alpha)
    return block


def sigma(alpha: float, reference_length: float = 0.1) -> float:
    """Extinction of an opacity, 1/m."""
    return float(-np.log1p(-alpha) / reference_length)
