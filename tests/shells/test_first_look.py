"""The first sample of a picture: what its fewer rays tell is laid out as said, and quieter; later samples have all."""

from __future__ import annotations

from collections.abc import Callable, Mapping
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
from renderer.shells.entries import Entries, Layers, View
from renderer.shells.renderer import ShellsRenderer
from renderer.shells.state import ShellsState

Spoil = Callable[..., Any]
FILE = "shells/first_look.glsl"
SIZE = (32, 26)
PLACES = 6
PATCH: dict[str, Any] = {
    "scene": "shells",
    "surface": {"kind": "sphere", "divisions": 3},
    "texture": {"kind": "fur", "across": 32, "strands": 5, "layers": 8},
    "sun": {"kind": "direction", "azimuth": 150, "elevation": 40},
    "shadow": {"kind": "deep_shadow_map", "softness": 0.0},
    "view": {"background": "none"},
}
"""Without the jitter of its shadows, which differs by the fragment of a ray."""

SPOILED = {1: ("size.y - place.y", "place.y"), 2: ("(square.x - square.y) / 2", "square.x / 2")}

GROUND = {
    "surface": {"kind": "plane", "size": 2.0},
    "texture": {"kind": "uniform"},
    "light": {"kind": "unlit"},
    "shadow": {"kind": "none"},
    "camera": {"kind": "orthographic", "centre": [0, 0, 0], "direction": [0, 0, -1], "up": [0, 1, 0], "width": 1},
}


def sampled(rays: int, **more: Any) -> ShellsState:
    """So many rays of two by two pixels; every sample of as many places, that they differ in nothing else."""
    sampling = {"kind": "quantiles", "first_rays": rays, "places": PLACES, "first_places": PLACES}
    return validate(ShellsState, {**PATCH, "sampling": sampling, **more})


def close(rays: int) -> ShellsState:
    """As by default, a quarter of the rays as presets have them, and so near that a voxel is some pixels wide, as it is
    in pictures of a useful size."""
    camera = {"kind": "orbit", "target": [0, 0, 0], "distance": 3, "azimuth": 150, "elevation": 20, "field_of_view": 7}
    sampling = {"kind": "quantiles", "first_rays": rays, **({"first_places": 6} if rays == 1 else {})}
    more = {"sampling": sampling, "shadow": {"kind": "deep_shadow_map"}}
    return validate(ShellsState, {**PATCH, **more, "camera": camera})


@pytest.fixture(scope="module")
def baked() -> Mapping[str, BakedArrays]:
    return baked_of(sampled(4))


def baked_of(state: ShellsState) -> Mapping[str, BakedArrays]:
    cache = Cache()
    return {bake.name: BakedArrays(bake_key(bake), bake_now(bake, cache)) for bake in bakes(state)}


def drawn(
    gl: GL, state: ShellsState, baked: Mapping[str, BakedArrays], size: tuple[int, int] = SIZE,
    offset: tuple[float, float] = (0.5, 0.5), *samples: int,
) -> np.ndarray:
    """The last of some samples that one renderer draws, by default the first."""
    renderer, target = ShellsRenderer(gl), Target(gl, *size)
    try:
        for sample in samples or (0,):
            prepared = renderer.prepare(state, baked, size, offset, sample)
            target.use()
            renderer.draw(prepared)
        return target.read().astype(np.float64)
    finally:
        renderer.release()
        target.release()


def between(rays: np.ndarray, first: float) -> np.ndarray:
    """Twin of `between_rays`, at every pixel of a picture twice as wide and high as what is given; of each axis, the
    place of the top-left ray in pixels' middles is `first`."""
    for axis in (0, 1):
        place = (np.arange(2 * rays.shape[axis]) - first) / 2
        low = np.floor(place).astype(int)
        part = (place - low).reshape([-1 if k == axis else 1 for k in range(rays.ndim)])
        ends = [np.take(rays, np.clip(low + n, 0, rays.shape[axis] - 1), axis) for n in (0, 1)]
        rays = (1 - part) * ends[0] + part * ends[1]
    return rays


def twin(thread: GLThread, baked: Mapping[str, BakedArrays], rays: int) -> np.ndarray:
    """The first sample, of rays from a picture with one for each pixel."""
    plain = sampled(4)
    if rays == 1:
        return between(thread.call(drawn, plain, baked, SIZE, (1.0, 1.0))[::2, ::2], 0.5)
    each = thread.call(drawn, plain, baked)
    row, column = (np.arange(side) % 2 for side in SIZE[::-1])
    odd = (row[:, None] + column)[..., None] / 2
    # A pixel's own ray, and those of its corners, by a bell of 0.65 px.
    across = 4 * np.exp(-1 / 0.65**2)
    share = np.where(odd == 0.5, 0.5, np.where(odd == 1, 1, across) / (1 + across))
    return np.asarray((1 - share) * between(each[::2, ::2], 0.0) + share * between(each[1::2, 1::2], 1.0))


@pytest.mark.parametrize("rays", [1, 2])
def test_rays_are_laid_out_as_the_twin_says(
    thread: GLThread, baked: Mapping[str, BakedArrays], rays: int, spoil: Spoil
) -> None:
    right = twin(thread, baked, rays)
    found = thread.call(drawn, sampled(rays), baked)
    apart = np.abs(found - right).max(axis=-1)
    # Where a ray grazes an edge of a cell, rounding says which one it meets.
    assert np.quantile(apart, 0.98) < 2e-3 * right.max()
    with spoil(FILE, *SPOILED[rays]):
        wrong = np.abs(thread.call(drawn, sampled(rays), baked) - right).max(axis=-1)
    assert np.quantile(wrong, 0.98) > 0.1 * right.max()


@pytest.mark.parametrize("rays", [1, 2])
@pytest.mark.parametrize("size", [(16, 12), (13, 9)])
def test_even_light_is_even_up_to_the_rim(thread: GLThread, rays: int, size: tuple[int, int]) -> None:
    """Matter of a few bytes differs by a hundredth from place to place."""
    found = thread.call(drawn, sampled(rays, **GROUND), baked_of(sampled(rays, **GROUND)), size)
    assert found[..., 3].min() > 0
    np.testing.assert_allclose(found, np.broadcast_to(found[4, 4], found.shape), rtol=0.02)


def test_nothing_is_drawn_beside_the_picture(
    thread: GLThread, monkeypatch: pytest.MonkeyPatch, spoil: Spoil
) -> None:
    """A shell beyond the rim of the picture on all sides: of slanting rows, what leads out of it stays empty."""
    covered, find = [], Entries.find

    def counted(entries: Entries, view: View) -> Layers:
        layers = find(entries, view)
        faces = np.frombuffer(layers.first.texture.read(), "f4").reshape(*view.size[::-1], 2)[..., 0]
        covered.append((view.size, int((faces >= 0).sum())))
        return layers

    monkeypatch.setattr(Entries, "find", counted)
    state = sampled(2, **GROUND)
    thread.call(drawn, state, baked_of(state), (16, 12))
    assert covered[-1] == ((6 + 8, 12), 16 * 12 // 2)
    with spoil("stages/mesh.vert", "dot(clip_first, place)", "1.0"):
        thread.call(drawn, state, baked_of(state), (16, 12))
    assert covered[-1][1] > 16 * 12 // 2


def test_a_first_sample_leaves_nothing_to_later_ones(thread: GLThread, baked: Mapping[str, BakedArrays]) -> None:
    alone = thread.call(drawn, sampled(2), baked, SIZE, (0.5, 0.5), 1)
    after = thread.call(drawn, sampled(2), baked, SIZE, (0.5, 0.5), 0, 1)
    np.testing.assert_array_equal(after, alone)


def test_half_the_rays_are_as_near_to_the_picture_and_later_samples_have_all(
    thread: GLThread, baked: Mapping[str, BakedArrays]
) -> None:
    def off(found: np.ndarray) -> float:
        return float(np.sqrt(np.mean((found - settled) ** 2)))

    offsets = [((0.5 + 0.7548777 * k) % 1, (0.5 + 0.5698403 * k) % 1) for k in range(32)]
    later = [thread.call(drawn, close(4), baked, SIZE, place, 1 + n) for n, place in enumerate(offsets)]
    settled = np.mean(later, axis=0)
    one, two, four = (thread.call(drawn, close(rays), baked) for rays in (1, 2, 4))
    assert off(two) < 1.1 * off(four)
    assert off(two) < off(one) < 1.8 * off(four)
    np.testing.assert_array_equal(thread.call(drawn, close(2), baked, SIZE, offsets[0], 1), later[0])
    assert one.mean() == pytest.approx(settled.mean(), rel=0.02)
    assert two.mean() == pytest.approx(settled.mean(), rel=0.02)
