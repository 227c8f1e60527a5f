"""The first sample of a picture: nothing is changed where all is alike, it is quiet where it is not, and fades out."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from renderer import view
from renderer.forest import program
from renderer.gl.thread import GLThread
from tests.forest import worlds
from tests.forest.truth import SCENE, SIDE, SKY, grove

Spoil = Callable[..., Any]


def drawn(thread: GLThread, painter: view.Painter, samples: int, blocks: int, patch: dict[str, Any] | None = None,
          size: tuple[int, int] = (SIDE, SIDE), longer: float = 1.0, pitch: int = 1) -> np.ndarray:
    """The grove with a traced shadow, (H, W, 4) float64; steps of the first sample so much `longer`, and `pitch` by
    `pitch` of its pixels with one ray."""
    geometry = worlds.technique("geometry", "ray_march", step=1.0, stop=0.02, first=longer, pitch=pitch)
    march = worlds.technique("shadow", "sun_march", step=1.0, growth=0.0, bias=-1.5, stop=0.02, blocks=blocks)
    made = worlds.state(**{**SCENE, **worlds.PLAIN, "shadow": march, "geometry": geometry, **(patch or {})})
    return view.paint(thread, painter, made, grove(made), size, samples).linear.astype(np.float64)


@pytest.fixture(scope="module")
def settled(thread: GLThread, painter: view.Painter) -> np.ndarray:
    """The picture of many samples, none of them a first look."""
    return drawn(thread, painter, 256, 1)


def off(found: np.ndarray, wanted: np.ndarray) -> float:
    """Relative RMSE of the colours."""
    return float(np.sqrt(np.mean((found - wanted)[..., :3] ** 2)) / wanted[..., :3].mean())


@pytest.mark.parametrize(("blocks", "share"), [(0, 0.8), (2, 0.85), (3, 1.0)])
def test_the_first_sample_is_quieter_than_a_plain_one(
    thread: GLThread, painter: view.Painter, settled: np.ndarray, blocks: int, share: float
) -> None:
    # Close by, where a block spans half a crown; over a valley it has half the noise of a plain sample.
    plain, first = (off(drawn(thread, painter, 1, side), settled) for side in (1, blocks))
    assert first < share * plain


def test_it_fades_from_the_picture(thread: GLThread, painter: view.Painter, settled: np.ndarray) -> None:
    for blocks in (0, 3):
        apart = off(drawn(thread, painter, 256, blocks), settled)
        assert apart < off(drawn(thread, painter, 1, blocks), settled) / 128


def test_its_brightness_is_that_of_the_picture(thread: GLThread, painter: view.Painter, settled: np.ndarray) -> None:
    first = drawn(thread, painter, 1, 3)
    # One look for nine pixels: two deviations of the mean over some five hundred of them.
    assert first[..., :3].mean() == pytest.approx(settled[..., :3].mean(), rel=0.1)


def test_what_voxels_know_of_the_sun_stands_for_rays_in_the_first_sample_alone(
    thread: GLThread, painter: view.Painter, settled: np.ndarray
) -> None:
    first, looked = (drawn(thread, painter, 1, blocks) for blocks in (0, 3))
    assert off(first, settled) < off(looked, settled)
    kept = drawn(thread, painter, 1, 0, {"shadow": worlds.technique("shadow", "voxel_transmittance", strength=1.0)})
    assert off(first, kept) > 0  # the same light, smoothed
    assert first[..., :3].mean() == pytest.approx(kept[..., :3].mean(), rel=0.02)
    second = [2 * drawn(thread, painter, 2, blocks) - one for blocks, one in ((0, first), (3, looked))]
    np.testing.assert_allclose(*second, atol=1e-5)


def test_rays_that_are_smoothed_together_share_the_levels_of_light(
    thread: GLThread, painter: view.Painter, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An even canopy, brighter the higher, shows no pattern: what is left is that of the voxels' offsets."""
    baked = worlds.together(sky=worlds.sky(SKY), terrain=worlds.ground(0.0), pattern=worlds.uniform(40))

    def uneven(seed: int) -> float:
        slots = {**worlds.PLAIN, "height_shading": worlds.technique("height_shading", "empirical"),
                 "geometry": worlds.technique("geometry", "ray_march", pitch=2)}
        given = {**slots, "ground": {"map_seed": seed}}
        made = worlds.state(camera=worlds.map_view(90, 60, 64), sun=worlds.sun(123, 30), **given)
        seen = view.paint(thread, painter, made, baked, (96, 96), 1).linear[8:-8, 8:-8, 1].astype(np.float64)
        return float(seen.std() / seen.mean())

    assert uneven(1) < 0.01
    monkeypatch.setattr(program, "RAY_OF_PIXEL", program.RAY_OF_PIXEL.replace("sample_smoothed > 0.0", "false"))
    program._composed.cache_clear()
    assert uneven(2) > 0.02  # another seed: what was traced is kept
    program._composed.cache_clear()


def test_steps_of_coarser_levels_are_long_enough(thread: GLThread, painter: view.Painter) -> None:
    # Two levels up a step of one voxel is four of the finest, and longer than the first sample's.
    for bias, apart in ((3.0, False), (-3.0, True)):
        patch = {"filter": worlds.technique("filter", "mipmap", bias=bias)}
        even, longer = (drawn(thread, painter, 1, 0, patch, longer=times) for times in (1.25, 2.5))
        assert (off(longer, even) > 0.01) == apart


def test_longer_steps_of_the_first_sample_are_lost_in_its_noise(
    thread: GLThread, painter: view.Painter, settled: np.ndarray
) -> None:
    even, longer = (drawn(thread, painter, 1, 3, longer=times) for times in (1.0, 2.0))
    assert off(longer, even) > 0
    assert off(longer, settled) < 1.05 * off(even, settled)
    second = [2 * drawn(thread, painter, 2, 3, longer=times) - first for times, first in ((1.0, even), (2.0, longer))]
    np.testing.assert_allclose(*second, atol=1e-5)


def spread_error(thread: GLThread, painter: view.Painter, size: tuple[int, int]) -> float:
    """Worst relative error of a ray for four pixels against a ray for each, over bare hills without any detail, whose
    light is all but linear; the rim apart, which has no neighbours to be linear between."""
    north, east = np.mgrid[2044.0:-2045.0:-8.0, -2044.0:2045.0:8.0]
    baked = worlds.together(
        sky=worlds.sky(SKY), terrain=worlds.ground(1e-3 * east**2 + 2e-3 * north**2, 0.0), pattern=worlds.uniform(0)
    )
    shown = []
    for pitch in (1, 2):
        given = {**worlds.PLAIN, "geometry": worlds.technique("geometry", "ray_march", pitch=pitch)}
        made = worlds.state(camera=worlds.map_view(90, 60, 64), sun=worlds.sun(123, 30), **given)
        shown.append(view.paint(thread, painter, made, baked, size, 1).linear[3:-3, 3:-3].astype(np.float64))
    return float(np.abs(shown[1] / shown[0] - 1).max())


@pytest.mark.parametrize("size", [(64, 48), (51, 37)])
def test_a_ray_for_four_pixels_stands_in_their_middle(
    thread: GLThread, painter: view.Painter, spoil: Spoil, size: tuple[int, int]
) -> None:
    # Normals are linear between nodes eight metres apart, so that their light bends there.
    assert spread_error(thread, painter, size) < 0.004
    with spoil("forest/first_look.glsl", "float(size.y) - 0.5 * pixel.y", "0.5 * pixel.y"):
        assert spread_error(thread, painter, size) > 0.02


def test_a_ray_for_four_pixels_is_smoothed_into_a_nearer_picture_than_a_plain_one(
    thread: GLThread, painter: view.Painter, settled: np.ndarray
) -> None:
    plain, four = drawn(thread, painter, 1, 1), drawn(thread, painter, 1, 0, longer=2.5, pitch=2)
    assert off(four, settled) < off(plain, settled)
    assert four[..., :3].mean() == pytest.approx(settled[..., :3].mean(), rel=0.1)
    odd = drawn(thread, painter, 1, 0, size=(51, 37), pitch=2)
    assert odd.shape == (37, 51, 4)
    assert odd[[0, -1], :, :3].min() > 0
    assert odd[:, [0, -1], :3].min() > 0
    one, other = (
        2 * drawn(thread, painter, 2, 0, pitch=pitch) - drawn(thread, painter, 1, 0, pitch=pitch) for pitch in (1, 2)
    )
    np.testing.assert_allclose(one, other, atol=1e-5)


def test_opacity_is_each_pixels_own(thread: GLThread, painter: view.Painter) -> None:
    shares = [drawn(thread, painter, 1, side, {"view": {"background": "none"}})[..., 3] for side in (1, 3)]
    np.testing.assert_allclose(*shares, atol=2e-6)


def test_a_size_that_blocks_do_not_divide_is_drawn_to_its_rim(thread: GLThread, painter: view.Painter) -> None:
    odd = drawn(thread, painter, 1, 3, size=(50, 37))
    assert odd.shape == (37, 50, 4)
    assert np.isfinite(odd).all()
    lit = odd[..., :3].sum(axis=-1)
    assert lit[-1].min() > 0
    assert lit[:, -1].max() > 0


def test_smoothing_across_distances_is_found(
    thread: GLThread, painter: view.Painter, settled: np.ndarray, spoil: Spoil
) -> None:
    right = off(drawn(thread, painter, 1, 3), settled)
    with spoil("forest/first_look.glsl", "near * near * alike(own.x, other.y)", "near * near * (1.0 - other.x)"):
        assert off(drawn(thread, painter, 1, 3), settled) > 1.2 * right
