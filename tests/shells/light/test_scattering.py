"""Scattered light: closed forms of its transfer, the shader and its twin, Mitsuba's picture of the shared volume."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
from scipy.ndimage import map_coordinates, zoom
from scipy.special import expn

from renderer.core.baking import bake_key, bake_now
from renderer.core.cache import Cache
from renderer.core.params import validate
from renderer.core.technique import BakedArrays
from renderer.gl.thread import GLThread
from renderer.shells.bakes import bakes
from renderer.shells.renderer import ShellsRenderer
from renderer.shells.state import ShellsState
from renderer.shells.transfer import TABLE, bake_transfer, coarsened, phase, transferred
from renderer.world.sky import sky_for
from tests.reference.shells import volume, volume_camera
from tests.reference.test_shells_paths import MITSUBA
from tests.shells.conftest import PLAIN, _picture

FILE = "shells/light/scattering.glsl"
SLAB: dict[str, Any] = {
    **PLAIN,
    "texture": {"kind": "uniform", "optical_depth": 1.4, "colour": [0.9, 0.6, 0.3]},
    "light": {"kind": "scattering", "asymmetry": 0.5, "across": 4, "walks": 4000},
    "sun": {"kind": "direction", "azimuth": 90.0, "elevation": 50.0},
    "sampling": {"kind": "uniform", "samples": 64},
}


def transfer(colour: Any, opacity: Any, **changes: Any) -> np.ndarray:
    """Numbers of each voxel (K, J, I, 16) of an even block, or of one given."""
    block = np.empty((6, 4, 4, 4), np.float32) if np.ndim(opacity) == 0 else np.empty((*opacity.shape, 4), np.float32)
    block[..., :3], block[..., 3] = colour, opacity
    texture = {"colour": block, "normal": np.zeros_like(block), "material": np.ones(block.shape[:3], np.uint8),
               "size": np.array([1.0, 1.0, 0.5]), "reference_length": np.array(0.1)}  # fmt: skip
    arguments = {"thickness": 0.5, "density": 1.0, "moment": {}, "repeats": True, "base": None, "asymmetry": 0.6,
                 "across": 32, "walks": 2000, **changes}  # fmt: skip
    given = {**texture, "reference_length": np.array(changes.pop("length", 0.1))}
    arguments.pop("length", None)
    table = bake_transfer(arguments, {"texture": given}, lambda *_: None)["table"].astype(float)
    return np.concatenate(np.split(table, 4), axis=-1)


def named(values: np.ndarray, name: str) -> np.ndarray:
    return values[..., TABLE.index(name)]


def test_black_matter_leaves_of_the_sky_what_an_exponential_integral_says() -> None:
    found = transfer(0.0, 0.3)
    sigma = -np.log(0.7) / 0.1
    edges = expn(3, sigma * 0.5 * (1 - np.arange(7) / 6))
    right = np.diff(edges) / (2 * sigma * 0.5 / 6)
    np.testing.assert_allclose(named(found, "sky red").mean(axis=(1, 2)), right, atol=3e-3)
    assert abs(found[..., 4:]).max() == 0


def test_white_matter_over_a_white_floor_is_a_furnace() -> None:
    """Whatever comes in goes out; the half that came from below without it is missing over an open one."""
    closed = transfer(1.0, 0.3, base=[1.0, 1.0, 1.0], walks=200)
    np.testing.assert_allclose(closed[..., :3], 1.0, atol=2e-3)
    opened = transfer(1.0, 0.3, walks=800)
    sky = named(opened, "sky green").mean(axis=(1, 2))
    # From a layer and from its mirror image together everything comes.
    np.testing.assert_allclose(sky + sky[::-1], 1.0, atol=0.02)
    assert (np.diff(sky) > 0).all()


def test_light_keeps_more_of_its_direction_where_it_is_scattered_forwards() -> None:
    even, forward = (transfer(0.9, 0.1, asymmetry=g, walks=500) for g in (0.0, 0.8))
    kept = [named(found, "G0").mean() / named(found, "F0 red").mean() for found in (even, forward)]
    assert abs(kept[0]) < 0.15
    assert kept[1] > 0.5


def test_means_are_of_whole_voxels() -> None:
    block = np.arange(5 * 2 * 4, dtype=float).reshape(5, 2, 4, 1)
    coarse = coarsened(block, 2)
    assert coarse.shape == (2, 2, 2, 1)
    assert coarse[1, 0, 0, 0] == block[3:, 0, :2].mean()


@pytest.fixture(scope="module")
def slab() -> tuple[ShellsState, Mapping[str, BakedArrays]]:
    state, cache = validate(ShellsState, SLAB), Cache()
    return state, {bake.name: BakedArrays(bake_key(bake), bake_now(bake, cache)) for bake in bakes(state)}


def expected(state: Any, baked: Mapping[str, BakedArrays]) -> np.ndarray:
    """Radiance of the slab seen from straight above, (3,), by the twin."""
    table = baked["transfer"].arrays["table"].astype(float)
    values = np.concatenate(np.split(table, 4), axis=-1).mean(axis=(1, 2))
    now = sky_for(baked["sky"].arrays, np.radians(50.0))
    sun = np.array([np.cos(np.radians(50)), 0.0, np.sin(np.radians(50))])
    steps = 640
    height = (np.arange(steps) + 0.5) / steps
    at = np.clip(height * len(values) - 0.5, 0, len(values) - 1)
    here = np.stack([np.interp(at, np.arange(len(values)), column) for column in values.T], axis=-1)
    sigma = 1.4 / 0.5
    seen = sigma * np.exp(-sigma * 0.5 * (1 - height)) * 0.5 / steps
    rise = np.maximum(1 - 3 * 0.5 * here[:, 3] / here[:, :3].mean(axis=-1), 0)
    source = np.asarray(now.sun_irradiance) * (phase(0.5, -sun[2]) + transferred(here, sun, -sun[2], 0.5))
    source += np.asarray(now.sky_irradiance) / np.pi * here[:, :3] * rise[:, None]
    found: np.ndarray = (seen[:, None] * source).sum(axis=0) * [0.9, 0.6, 0.3]
    return found


def test_the_shader_is_its_twin_and_a_lobe_that_is_not_widened_is_found(
    thread: GLThread, slab: tuple[ShellsState, Mapping[str, BakedArrays]], spoil: Callable
) -> None:
    right = expected(*slab)
    seen = thread.call(_picture, *slab, 8, 1)[..., :3].mean(axis=(0, 1))
    np.testing.assert_allclose(seen, right, rtol=0.02)
    with spoil(FILE, "light_phase(light_lobe * lobe, mu)", "light_phase(lobe, mu)"):
        wrong = thread.call(_picture, *slab, 8, 1)[..., :3].mean(axis=(0, 1))
    assert abs(wrong / right - 1).max() > 0.05


def test_white_matter_over_a_white_floor_looks_like_the_sky(
    thread: GLThread, monkeypatch: pytest.MonkeyPatch, spoil: Callable
) -> None:
    """Where the sun is out: whatever share of it matter hides, floor and matter have the sky's radiance."""
    white = {**SLAB, "texture": {**SLAB["texture"], "colour": [1, 1, 1]}, "base": {"colour": [1, 1, 1], "opaque": True}}
    state, cache = validate(ShellsState, white), Cache()
    baked = {bake.name: BakedArrays(bake_key(bake), bake_now(bake, cache)) for bake in bakes(state)}
    light = ShellsRenderer._light

    def without_sun(self: ShellsRenderer, *given: Any) -> dict[str, Any]:
        return light(self, *given) | {"sun_irradiance": (0.0, 0.0, 0.0)}

    monkeypatch.setattr(ShellsRenderer, "_light", without_sun)
    sky = np.asarray(sky_for(baked["sky"].arrays, np.radians(50.0)).sky_irradiance) / np.pi
    seen = thread.call(_picture, state, baked, 8, 1)[..., :3].mean(axis=(0, 1))
    np.testing.assert_allclose(seen, sky, rtol=0.01)
    with spoil(FILE, "max(2.0 * mean - colour * direct, 0.0) / (1.0 + colour)", "mean / (1.0 + colour)"):
        dim = thread.call(_picture, state, baked, 8, 1)[..., :3].mean(axis=(0, 1))
    assert (dim < 0.95 * sky).all()


@pytest.mark.slow
def test_the_shared_volume_is_within_a_twentieth_of_mitsubas_picture() -> None:
    """Blocks of 16 x 16 pixels, where matter is: relative RMSE of 3 %, and of single scattering alone of 21 %."""
    opacity = volume()[..., 3]
    changes = {"length": 1 / 64, "repeats": False, "walks": 128}
    found = transfer(0.99, opacity, **changes)
    below = transfer(0.99, opacity[::-1], **changes)[::-1]
    sun = np.array([-0.3, -0.4, 0.866]) / np.linalg.norm([0.3, 0.4, 0.866])
    origins, ways = volume_camera(*np.mgrid[0:128:2, 0:128:2] + 0.5)((0.5, 0.5))
    along = ways.reshape(-1, 3)[0]
    cosine = float(along @ sun)
    sigma = -np.log1p(-np.minimum(opacity, 1 - 2.0**-12)) * 64
    depth = depths(sigma, sun)
    coarse = 0.3 * (found[..., 0] + below[..., 0]) + 3 * transferred(found, sun, cosine, 0.6)[..., 0]
    later = zoom(coarse, np.array(sigma.shape) / coarse.shape, order=1, mode="nearest", grid_mode=True)
    first = 3 * phase(0.6, cosine) * np.exp(-depth)
    errors = []
    for source in (first + later, first + 0.3):
        blocks = picture(origins.reshape(-1, 3), along, sigma, 0.99 * source).reshape(8, 8, 8, 8).mean(axis=(1, 3))
        there = MITSUBA > 0.305
        errors.append(float(np.sqrt(np.mean((blocks - MITSUBA)[there] ** 2)) / MITSUBA[there].mean()))
    assert errors[0] < 0.05
    assert errors[1] > 2 * errors[0]


def read(values: np.ndarray, places: np.ndarray) -> np.ndarray:
    """A block's values at places (N, 3) [m] of a box of 1 x 1 x 0.5 m; none outside."""
    inside = ((places > 0) & (places < [1, 1, 0.5])).all(axis=-1)
    at = (places[:, ::-1] * 64 - 0.5).T
    return np.where(inside, map_coordinates(values, at, order=1, mode="nearest"), 0.0)


def depths(sigma: np.ndarray, sun: np.ndarray, steps: int = 48) -> np.ndarray:
    """Optical depth from each voxel's centre to the sun."""
    centre = np.stack(np.meshgrid(*(np.arange(n) + 0.5 for n in sigma.shape), indexing="ij")[::-1], axis=-1) / 64
    stride = 1.2 / steps
    total = sum(read(sigma, centre.reshape(-1, 3) + (n + 0.5) * stride * sun) for n in range(steps))
    return np.asarray(total).reshape(sigma.shape) * stride


def picture(origins: np.ndarray, along: np.ndarray, sigma: np.ndarray, source: np.ndarray) -> np.ndarray:
    """Radiance (N,) before a background of 0.3."""
    steps = 160
    stride = 2.0 / steps
    left, radiance = np.ones(len(origins)), np.zeros(len(origins))
    for n in range(steps):
        places = origins + (1.0 + (n + 0.5) * stride) * along
        passed = np.exp(-read(sigma, places) * stride)
        radiance += left * (1 - passed) * read(source, places)
        left *= passed
    return radiance + 0.3 * left
