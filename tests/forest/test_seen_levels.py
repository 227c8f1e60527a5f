"""Coarser levels as the eye meets them: what a ray sees through them, against the finest level and closed forms."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from renderer.forest import seen_levels as module
from renderer.forest.pattern import AXES
from renderer.forest.pattern_mips import LEVELS
from renderer.forest.seen_kernels import follow_light
from renderer.forest.seen_levels import AZIMUTHS, ELEVATIONS, blocks, seen_levels
from renderer.forest.world_scale import VOXEL

SHAPE = (32, 32, 32)


def level(opacity: np.ndarray, albedo: np.ndarray | float = 0.4) -> dict[str, np.ndarray]:
    """The finest level of a pattern with these opacities (of 255)."""
    light = np.broadcast_to(np.asarray(albedo), opacity.shape)[..., None] * opacity[..., None]
    colour = np.concatenate([np.rint(np.repeat(light, 3, axis=-1)), opacity[..., None]], axis=-1).astype(np.uint8)
    anchor = np.full((*opacity.shape, 4), 128, np.uint8)
    anchor[..., 2] = opacity == 0
    return {"colour": colour, "anchor": anchor}


def made(opacity: np.ndarray, albedo: np.ndarray | float = 0.4) -> dict[str, np.ndarray]:
    return seen_levels(level(opacity, albedo), AXES, VOXEL, lambda share: None)


def crowns(seed: int = 3) -> np.ndarray:
    """Dense balls in the air above a thin undergrowth."""
    rng = np.random.default_rng(seed)
    k, j, i = np.meshgrid(*(np.arange(n) for n in SHAPE), indexing="ij")
    opacity = np.where(k < 2, 30.0, 0.0)
    for z, y, x, r in zip(rng.uniform(10, 24, 9), *rng.uniform(0, 32, (2, 9)), rng.uniform(4, 7, 9), strict=True):
        away = [np.abs((a - c + 16) % 32 - 16) for a, c in ((j, y), (i, x))]
        opacity[(away[0] ** 2 + away[1] ** 2 + (k - z) ** 2) < r**2] = 150
    return opacity


def transmitted(opacity: np.ndarray, elevation: float) -> np.ndarray:
    """Mean transmittance from above to each layer's lower side, over the azimuths that a level averages."""
    alpha = np.minimum(opacity / 255, 1 - 2.0**-12)
    extinction = (-np.log1p(-alpha) / VOXEL).astype(np.float32)
    light, stopped = np.zeros_like(extinction), np.zeros_like(extinction)
    for azimuth in np.arange(AZIMUTHS) * 2 * np.pi / AZIMUTHS:
        run = VOXEL / np.tan(elevation)
        shift = run * np.array([np.sin(azimuth), np.cos(azimuth)]) @ np.linalg.inv(AXES)
        follow_light(extinction, shift, VOXEL / np.sin(elevation), 4, light, stopped)
    return 1 - np.cumsum(stopped[::-1].mean(axis=(1, 2)))[::-1] / AZIMUTHS


def seen_error(found: dict[str, np.ndarray], opacity: np.ndarray, number: int, elevation: float) -> float:
    """Worst difference of the mean transmittance to any layer through a level and through the finest."""
    coarse = np.repeat(np.repeat(found[f"seen_{number}"][..., 3].astype(float), 2**number, 1), 2**number, 2)
    return float(np.abs(transmitted(coarse, elevation) - transmitted(opacity, elevation)).max())


@pytest.mark.parametrize("number", range(1, LEVELS + 1))
def test_fog_is_the_same_at_every_level(number: int) -> None:
    found = made(np.full(SHAPE, 20.0))[f"seen_{number}"]
    # Rounded to the byte above or below.
    assert np.abs(found[..., 3].astype(float) - 20).max() <= 1
    np.testing.assert_allclose(found[..., 3].mean(), 20, atol=0.1)
    assert (found[..., :3] == 102).all()


def test_light_falls_through_a_slab_as_beer_and_lambert_say() -> None:
    elevation, alpha = float(ELEVATIONS[0]), 20 / 255
    below = np.arange(SHAPE[0])[::-1] + 1
    exact = (1 - alpha) ** (below / np.sin(elevation))
    np.testing.assert_allclose(transmitted(np.full(SHAPE, 20.0), elevation), exact, atol=1e-6)


def averaged(opacity: np.ndarray) -> dict[str, np.ndarray]:
    """What the matter's plain mean would be."""
    result, mean = {}, opacity[..., None]
    for number in range(1, LEVELS + 1):
        mean = blocks(mean).mean(axis=3)
        result[f"seen_{number}"] = np.repeat(mean, 4, axis=-1)
    return result


def one_elevation(monkeypatch: pytest.MonkeyPatch, light: Any = None) -> float:
    """Error of the coarsest level, one block as wide as the pattern, towards the only elevation it was made for."""
    elevation = float(ELEVATIONS[1])
    monkeypatch.setattr(module, "ELEVATIONS", np.array([elevation]))
    if light is not None:
        monkeypatch.setattr(module, "_light", light)
    opacity = crowns()
    return seen_error(made(opacity), opacity, LEVELS, elevation)


def test_one_block_lets_through_what_its_voxels_do(monkeypatch: pytest.MonkeyPatch) -> None:
    """The mean transmittance T falls by mean(sigma T) dz, exactly: left are bytes, half a one in each of the layers,
    and the light that every voxel gets."""
    assert one_elevation(monkeypatch) < 0.01


def test_without_the_light_that_reaches_it_matter_is_too_dense(monkeypatch: pytest.MonkeyPatch) -> None:
    assert one_elevation(monkeypatch, lambda a, *_: (np.ones((1, *a.shape), np.float32), -np.log1p(-a)[None])) > 0.1


@pytest.mark.parametrize("number", [3, 4, 5])
@pytest.mark.parametrize("elevation", [30.0, 55.0])
def test_between_the_elevations_a_level_is_nearer_than_the_plain_mean(number: int, elevation: float) -> None:
    """Of blocks as wide as crowns; in smaller ones these even balls have little to hide behind."""
    opacity = crowns()
    mean = opacity[..., None]
    for _ in range(number):
        mean = blocks(mean).mean(axis=3)
    plain = {f"seen_{number}": np.repeat(mean, 4, axis=-1)}
    found = seen_error(made(opacity), opacity, number, np.radians(elevation))
    assert found < 0.6 * seen_error(plain, opacity, number, np.radians(elevation))


def test_colour_is_that_of_what_is_seen() -> None:
    """Two sheets: layers are never mixed, and beside each other all count that are lit alike."""
    opacity, albedo = np.zeros(SHAPE), np.zeros(SHAPE)
    opacity[20], opacity[10] = 255, 255
    albedo[20, :, ::2], albedo[20, :, 1::2] = 0.8, 0.4
    found = made(opacity, albedo)["seen_1"]
    np.testing.assert_allclose(found[20, ..., 0], 0.6 * 255, atol=1)
    assert (found[19, ..., 3] == 0).all()
    assert (found[10, ..., 0] == 0).all()
    assert found[[10, 20], ..., 3].min() >= 254


def blackest(opacity: np.ndarray) -> float:
    """Least albedo of what is seen, at any coarser level, of matter that has one albedo of 0.4."""
    found = made(opacity)
    seen = [found[f"seen_{number}"] for number in range(1, LEVELS + 1)]
    return min(float(one[..., :3][one[..., 3] > 0].min()) for one in seen) / 255


def test_the_rim_of_a_crown_has_its_albedo() -> None:
    # The albedo is a byte times the opacity in the finest level, 0.5 of 30 at most off.
    assert blackest(crowns()) > 0.4 - 0.5 / 30 - 0.5 / 255


def test_a_black_rim_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """What a direction's rays stop beside a crown is the crown's: counted as the air's own, it was black."""
    monkeypatch.setattr(module, "CARRIED", 0)
    assert blackest(crowns()) == 0


def test_the_anchor_is_that_of_the_child_that_shows_most() -> None:
    opacity = np.zeros(SHAPE)
    opacity[8, 0, 1], opacity[8, 1, 0] = 200, 90
    given: Any = level(opacity)
    given["anchor"][8, 0, 1, :2], given["anchor"][8, 1, 0, :2] = (7, 9), (200, 201)
    given["anchor"][8, :, :, 2] = 5
    given["anchor"][8, 0, 1, 2] = 0
    found = seen_levels(given, AXES, VOXEL, lambda share: None)["seen_1"]
    assert found[8, 0, 0, 4:7].tolist() == [7, 9, 0]
    assert found[8, 5, 5, 6] == 5
