"""Rays that were followed before are lit as if they were followed anew."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
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
from renderer.shells.entries import Layers
from renderer.shells.renderer import ShellsRenderer
from renderer.shells.state import ShellsState

SIZE = (32, 32)
PATCH: dict[str, Any] = {
    "scene": "shells",
    "surface": {"kind": "sphere", "divisions": 3},
    "texture": {"kind": "fur", "across": 32, "strands": 5, "layers": 8},
    "view": {"background": "none"},
}


BALL = {"kind": "ball", "position": [0.4, -1.4, -0.2], "radius": 0.3, "colour": [0.5, 0.4, 0.3]}


def sunlit(azimuth: float, **more: Any) -> ShellsState:
    return validate(ShellsState, {**PATCH, "sun": {"kind": "direction", "azimuth": azimuth, "elevation": 40}, **more})


def pictures(gl: GL, shown: Sequence[tuple[ShellsState, Mapping[str, BakedArrays]]]) -> list[np.ndarray]:
    """By one renderer, one after the other."""
    renderer, target, found = ShellsRenderer(gl), Target(gl, *SIZE), []
    try:
        for state, baked in shown:
            prepared = renderer.prepare(state, baked, SIZE, (0.5, 0.5), 0)
            target.use()
            renderer.draw(prepared)
            found.append(target.read())
        return found
    finally:
        renderer.release()
        target.release()


def baked_of(state: ShellsState) -> dict[str, BakedArrays]:
    cache = Cache()
    return {bake.name: BakedArrays(bake_key(bake), bake_now(bake, cache)) for bake in bakes(state)}


@pytest.mark.parametrize("rays", [1, 2, 4])
def test_rays_that_other_meshes_end_are_kept_with_them(
    thread: GLThread, rays: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    beside: dict[str, Any] = {"things": {"list": [BALL]}, "sampling": {"kind": "quantiles", "first_rays": rays}}
    aside = {**beside, "things": {"list": [{**BALL, "position": [-0.3, -1.4, 0.1]}]}}
    first, moved, changed = sunlit(150, **beside), sunlit(230, **beside), sunlit(150, **aside)
    baked, other = baked_of(first), baked_of(changed)
    anew = thread.call(pictures, [(moved, baked)])[0]
    followed: list[Any] = []
    draw = Layers.draw

    def told(self: Layers, kinds: Any, *of: Any, **named: Any) -> Any:
        shows, before = of[4] if len(of) > 4 else None, self._shown.get(kinds)
        followed.append(shows is not None and shows[0] == "trace" and shows != before)
        return draw(self, kinds, *of, **named)

    monkeypatch.setattr(Layers, "draw", told)
    np.testing.assert_array_equal(thread.call(pictures, [(first, baked), (moved, baked)])[1], anew)
    assert sum(followed) == 1, "once, for both suns"
    after = thread.call(pictures, [(first, baked), (changed, other)])[1]
    np.testing.assert_array_equal(after, thread.call(pictures, [(changed, other)])[0])


def test_a_moved_sun_lights_what_was_followed(thread: GLThread, monkeypatch: pytest.MonkeyPatch) -> None:
    first, moved = sunlit(150), sunlit(230)
    baked = baked_of(first)
    anew = thread.call(pictures, [(moved, baked)])[0]
    after = thread.call(pictures, [(first, baked), (moved, baked)])
    np.testing.assert_array_equal(after[1], anew)
    assert np.abs(after[0] - anew).max() > 1, "the sun did move"
    finer = sunlit(150, sampling={"kind": "quantiles", "rate": 3.0})
    right = thread.call(pictures, [(finer, baked)])[0]
    np.testing.assert_array_equal(thread.call(pictures, [(first, baked), (finer, baked)])[1], right)
    # Were rays kept whatever changed, other samples would show the old ones.
    draw = Layers.draw

    def spoilt(self: Layers, *of: Any, **named: Any) -> Any:
        shown = [*of]
        if len(shown) > 5 and shown[5] is not None:
            shown[5] = "always"
        return draw(self, *shown, **named)

    monkeypatch.setattr(Layers, "draw", spoilt)
    assert np.abs(thread.call(pictures, [(first, baked), (finer, baked)])[1] - right).max() > 0
