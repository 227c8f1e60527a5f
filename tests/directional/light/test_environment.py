"""Surroundings: irradiance against sums over the picture, mirrors, rotation, smoother levels, GLSL against its twin."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from renderer.core.cache import AssetStore
from renderer.core.errors import InputError
from renderer.directional.environment_light import BANDS, SHARPEST, harmonics_of, irradiance, level_of, polynomials
from renderer.directional.environment_pictures import PICTURES, ROWS, directions, fewer, resampled, solid_angles
from renderer.directional.environments import (
    Evening,
    Own,
    SceneSky,
    Studio,
    background_of,
    bake_environment,
    environment_bake,
    environment_macros,
    image_of,
    user_picture,
)
from renderer.directional.light.environment import EnvironmentMap
from renderer.directional.light.phong import Phong
from renderer.gl.thread import GLThread
from renderer.world.image import save_image
from renderer.world.sky import sky_for, sky_radiance
from renderer.world.sun import SunDirection, direction
from tests.directional.light.points import COLOUR, SHADE, kept, random_directions, shaded, sky_tables

SUN = SunDirection(azimuth=205.0, elevation=35.0)


def quiet(share: float, words: str) -> None:
    """Progress that nobody watches."""


@pytest.fixture(scope="module")
def baked() -> Mapping[str, Any]:
    """The default sky and the studio."""
    return {"sky": sky_tables(), "environment": kept(environment_bake(Studio())[0])}


def everywhere(count: int, seed: int) -> np.ndarray:
    ways = random_directions(count, seed)
    ways[::2] *= -1
    return ways


def summed(image: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Irradiance (N, 3) by every texel's light."""
    light = (image * solid_angles(*image.shape[:2])[..., None]).reshape(-1, 3)
    return np.asarray(np.maximum(normals @ directions(*image.shape[:2]).reshape(-1, 3).T, 0) @ light)


def test_an_even_picture_sends_pi_and_a_cap_of_light_its_closed_form() -> None:
    even = harmonics_of(np.ones((64, 128, 3)))
    np.testing.assert_allclose(irradiance(even, everywhere(50, 1)), math.pi, rtol=1e-4)
    # the upper half of the sphere: pi (1 + cos t) / 2
    normals, half = everywhere(200, 2), np.zeros((64, 128, 3))
    half[:32] = 1
    closed = np.broadcast_to(math.pi * (1 + normals[:, 2:]) / 2, (200, 3))
    assert np.abs(irradiance(harmonics_of(half), normals) - closed).max() < 0.002  # of pi: odd bands are linear alone


@pytest.mark.parametrize(("name", "worst", "rms"), [("studio", 0.035, 0.012), ("evening", 0.065, 0.014)])
def test_harmonics_against_sums_over_the_picture(name: str, worst: float, rms: float) -> None:
    """Bands above the fourth are left out: of the mean irradiance 3 % at worst in the studio, 6 % under a small sun;
    bands to the second, alone, err three times as much."""
    image, normals = fewer(PICTURES[name](), 64), everywhere(300, 3)
    right, found = summed(image, normals), harmonics_of(image)
    error = irradiance(found, normals) - right
    assert np.abs(error).max() < worst * right.mean()
    assert np.sqrt((error**2).mean() / (right**2).mean()) < rms
    second = polynomials(*normals.T)[: BANDS.index(4)].T @ found[: BANDS.index(4)] - right
    assert (second**2).mean() > 4 * (error**2).mean()


def test_the_sky_of_the_moment_needs_no_picture(baked: Mapping[str, Any]) -> None:
    """Weights of its small picture give the same as a picture of all directions made of it."""
    now, sun = sky_for(baked["sky"], math.radians(35.0)), np.asarray(direction(SUN))
    normals = everywhere(200, 4)
    image = fewer(image_of(SceneSky(), baked, now, sun), 64)
    technique = EnvironmentMap(diffuse=1.0, specular=0.0)
    said = technique.constants(_state(SceneSky()), baked)
    own = turned(normals, math.atan2(sun[0], sun[1]))
    right = summed(image, normals)
    assert np.abs(irradiance(said["environment_harmonics"], own) / right - 1).max() < 0.03


def turned(ways: np.ndarray, turn: float) -> np.ndarray:
    """Directions in the frame of a picture that is turned clockwise about the zenith."""
    c, s = math.cos(turn), math.sin(turn)
    return np.stack([ways[:, 0] * c - ways[:, 1] * s, ways[:, 1] * c + ways[:, 0] * s, ways[:, 2]], axis=1)


def _state(environment: Any) -> Any:
    return SimpleNamespace(environment=environment, sun=SUN)


def drawn(thread: GLThread, baked: Mapping[str, Any], technique: EnvironmentMap, environment: Any) -> tuple:
    """As drawn (N, 3), with normals, views and openness."""
    normals, openness = everywhere(400, 5), np.random.default_rng(6).random(400)
    to_eye = random_directions(400, 7)
    to_eye *= np.sign((to_eye * normals).sum(axis=1))[:, None]
    used = baked if environment.kind != "sky" else {"sky": baked["sky"]}
    around = {"environment": environment, "sun": SUN}
    sun = np.asarray(direction(SUN))
    seen = shaded(thread, technique, used, normals, to_eye, sun, openness=openness, surroundings=around)
    return seen, normals, to_eye, openness


def looked_up(image: np.ndarray, ways: np.ndarray, rotation: float) -> np.ndarray:
    """Bilinear between texels' middles, columns closed, rows ending at the poles."""
    rows, columns = image.shape[:2]
    across = ((np.arctan2(ways[:, 0], ways[:, 1]) - rotation) / (2 * math.pi) * columns - 0.5) % columns
    down = np.clip(np.arccos(np.clip(ways[:, 2], -1, 1)) / math.pi * rows - 0.5, 0, rows - 1)
    i, j = np.minimum(down.astype(int), rows - 2), across.astype(int) % columns
    v, u = (down - i)[:, None], (across - np.floor(across))[:, None]
    upper, lower = ((1 - u) * image[r, j] + u * image[r, (j + 1) % columns] for r in (i, i + 1))
    return np.asarray((1 - v) * upper + v * lower)


@pytest.mark.parametrize("rotation", [0.0, 77.0])
def test_matt_and_mirrored_light_of_a_picture(thread: GLThread, baked: Mapping[str, Any], rotation: float) -> None:
    environment = Studio(rotation=rotation, level=50.0)
    found, normals, to_eye, openness = drawn(thread, baked, EnvironmentMap(diffuse=0.7, specular=0.4), environment)
    image, turn = np.asarray(baked["environment"]["image"], np.float64) * 50.0, math.radians(rotation)
    own = turned(normals, turn)
    matt = 0.7 * COLOUR / math.pi * irradiance(baked["environment"]["harmonics"] * 50.0, own) * openness[:, None]
    mirrored = 2 * (to_eye * normals).sum(axis=1, keepdims=True) * normals - to_eye
    mirror = 0.4 * SHADE * looked_up(image, mirrored, turn)
    off = np.abs(found - matt - mirror)
    # an arc tangent of the driver's is good to some 1e-4 rad, which is a hundredth of a texel of up to 450 W m-2 sr-1
    assert np.quantile(off, 0.95) < 0.02
    assert off.max() < 8


def test_what_stands_behind_is_what_is_mirrored(baked: Mapping[str, Any]) -> None:
    """A picture where the light takes one, the sky where it does not."""
    now, sun, ways = sky_for(baked["sky"], math.radians(35.0)), np.asarray(direction(SUN)), everywhere(300, 8)
    state = SimpleNamespace(environment=Studio(rotation=50.0, level=3.0), light=EnvironmentMap(), sun=SUN)
    image = np.asarray(baked["environment"]["image"], np.float64) * 3.0
    seen = background_of(state, baked, now, sun)(ways)
    np.testing.assert_allclose(seen, looked_up(image, ways, math.radians(50.0)), rtol=1e-9)
    assert environment_macros(state) == {"ENVIRONMENT_SKY": "0", "ENVIRONMENT_BEHIND": "1"}
    state.light = Phong()
    np.testing.assert_allclose(background_of(state, baked, now, sun)(ways), sky_radiance(now, sun, ways))
    assert environment_macros(state)["ENVIRONMENT_BEHIND"] == "0"


def test_matt_and_mirrored_light_of_the_sky(thread: GLThread, baked: Mapping[str, Any]) -> None:
    technique = EnvironmentMap(diffuse=0.5, specular=0.5)
    found, normals, to_eye, openness = drawn(thread, baked, technique, SceneSky(level=2.0))
    now, sun = sky_for(baked["sky"], math.radians(35.0)), np.asarray(direction(SUN))
    image = image_of(SceneSky(level=2.0), baked, now, sun)
    mirrored = 2 * (to_eye * normals).sum(axis=1, keepdims=True) * normals - to_eye
    matt = 0.5 * COLOUR / math.pi * summed(fewer(image, 64), normals) * openness[:, None]
    right = matt + 0.5 * SHADE * looked_up(image, mirrored, 0.0)
    assert np.quantile(np.abs(found / right - 1), 0.95) < 0.01


@pytest.mark.parametrize(("right", "wrong"), [
    ("(surfel.openness / ENVIRONMENT_PI)", "surfel.openness"),
    ("2.0 * dot(to_eye, surfel.normal) * surfel.normal - to_eye", "to_eye"),
    ("across * (five - 1.0) * environment_harmonics[15]", "across * (five - 3.0) * environment_harmonics[15]"),
])  # fmt: skip
def test_spoiled_surroundings_are_found(
    thread: GLThread, baked: Mapping[str, Any], spoil: Callable, right: str, wrong: str
) -> None:
    with spoil("directional/environment_light.glsl", right, wrong), pytest.raises(AssertionError):
        test_matt_and_mirrored_light_of_a_picture(thread, baked, 77.0)


def test_a_picture_turned_the_other_way_is_found(thread: GLThread, baked: Mapping[str, Any], spoil: Callable) -> None:
    right, wrong = "direction.x * turn.x - direction.y * turn.y", "direction.x * turn.x + direction.y * turn.y"
    with spoil("directional/surroundings.glsl", right, wrong), pytest.raises(AssertionError):
        test_matt_and_mirrored_light_of_a_picture(thread, baked, 77.0)


def test_smoother_levels_keep_the_light_and_see_through_their_lobe(baked: Mapping[str, Any]) -> None:
    arrays = baked["environment"]
    whole = (arrays["image"] * solid_angles(ROWS, 2 * ROWS)[..., None]).sum(axis=(0, 1))
    ways = directions(ROWS, 2 * ROWS).reshape(-1, 3)
    light = (np.asarray(arrays["image"], np.float64) * solid_angles(ROWS, 2 * ROWS)[..., None]).reshape(-1, 3)
    for number in range(1, int(arrays["levels"]) + 1):
        level = arrays[f"level_{number}"]
        rows = len(level)
        assert rows == ROWS >> number
        left = (level * solid_angles(rows, 2 * rows)[..., None]).sum(axis=(0, 1))
        assert left == pytest.approx(whole, rel=2e-3)
        if number in (3, 5):  # against the lobe over the finest picture
            exponent, i, j = SHARPEST / 4**number, rows // 3, rows // 2
            lobe = np.maximum(ways @ directions(rows, 2 * rows)[i, j], 0) ** exponent
            exact = (lobe @ light) / (lobe @ solid_angles(ROWS, 2 * ROWS).ravel())
            assert level[i, j] == pytest.approx(exact, rel=0.05)
    assert level_of(SHARPEST) == 0
    assert level_of(SHARPEST / 16) == 2


def test_a_rough_mirror_sees_a_smoother_level(thread: GLThread, baked: Mapping[str, Any]) -> None:
    technique = EnvironmentMap(diffuse=0.0, specular=1.0, shininess=SHARPEST / 4**3)
    found, normals, to_eye, _ = drawn(thread, baked, technique, Studio(level=1.0))
    mirrored = 2 * (to_eye * normals).sum(axis=1, keepdims=True) * normals - to_eye
    right = SHADE * looked_up(np.asarray(baked["environment"]["level_3"], np.float64), mirrored, 0.0)
    assert np.quantile(np.abs(found - right) / right, 0.95) < 5e-3


def test_a_picture_of_ones_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its light is kept, whatever its size; one that covers no sphere is refused in words."""
    monkeypatch.setenv("UMBRAGE_CACHE", str(tmp_path))
    store = AssetStore()
    wide = np.ones((100, 200, 4), np.float32)
    wide[10:20, 30:40, :3] = 500.0
    asset = "asset:" + store.put(save_image("exr", wide), "image", "mine.exr")
    found = user_picture(asset)
    light = (wide[..., :3] * solid_angles(100, 200)[..., None]).sum(axis=(0, 1))
    left = (found * solid_angles(ROWS, 2 * ROWS)[..., None]).sum(axis=(0, 1))
    assert left == pytest.approx(light, rel=0.01)
    square = "asset:" + store.put(save_image("exr", wide[:, :100]), "image", "square.exr")
    with pytest.raises(InputError, match="twice as wide as high") as refused:
        bake_environment(Own(asset=square).model_dump(), {}, quiet)
    assert refused.value.field == "environment.asset"


def test_large_pictures_are_averaged_not_skipped() -> None:
    fine = np.zeros((256, 512, 3))
    fine[::4, ::4] = 16.0
    assert resampled(fine, 64)[32] == pytest.approx(1.0, rel=1e-2)
    assert Evening().level == Studio().level
