"""Three levels: their sum, their shader, their distance from the exact kernel for each reading."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.clouds.bounce.fft import Fft
from renderer.clouds.bounce.three_level import ThreeLevel
from renderer.clouds.radiosity.bases import GRID
from tests.clouds.bounce.conftest import Shown, maps, middles, uneven

GLSL = "clouds/bounce/three_level.glsl"
READINGS = ("texels", "taps", "discs")


@pytest.mark.parametrize("reading", READINGS)
def test_even_planes_give_the_closed_sum(shown: Shown, reading: str) -> None:
    technique = ThreeLevel(reading=reading)  # type: ignore[arg-type]
    solved = technique.solve(maps(), None, {})
    np.testing.assert_allclose(solved.added.ground, 200 * 0.18 / 0.82, rtol=1e-4)
    ground, cloud = shown(technique, None, solved, middles()[0][::100])
    np.testing.assert_allclose(ground, 200 * 0.18 / 0.82, rtol=1e-4)
    np.testing.assert_allclose(cloud, 60 / 0.82, rtol=1e-4)


def twin_error(shown: Shown, reading: str = "taps") -> float:
    """Worst distance of the shader's last half-bounce from the solved sum, over the mean."""
    technique = ThreeLevel(reading=reading, bounces=12)  # type: ignore[arg-type]
    solved = technique.solve(uneven(), None, {})
    places, (rows, columns) = middles()
    worst = 0.0
    for found, field in zip(
        shown(technique, None, solved, places), (solved.added.ground, solved.added.cloud), strict=True
    ):
        worst = max(worst, float(np.abs(found - field[rows, columns]).max() / field.mean()))
    return worst


@pytest.mark.parametrize("reading", READINGS)
def test_the_shader_makes_the_last_half_bounce(shown: Shown, reading: str) -> None:
    assert twin_error(shown, reading) < 1e-3


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("bounce_weights.x * textureLod", "bounce_weights.y * textureLod"),
        ("vec2(0.0, 2.0 / 3.0)", "vec2(0.0, 1.0 / 3.0)"),
        ("bounce_sum(bounce_cloud_map, at)", "bounce_sum(bounce_ground_map, at)"),
    ],
)
def test_a_wrong_sum_is_found(shown: Shown, spoil: Callable, right: str, wrong: str) -> None:
    with spoil(GLSL, right, wrong):
        assert twin_error(shown) > 5e-3


def distance(reading: str, bounces: int = 8) -> float:
    """Relative RMSE from the exact kernel under broken cloud, over the render square."""
    x, y = np.meshgrid(np.arange(GRID), np.arange(GRID))
    broken = maps(ground=200 + 600 * ((x // 7 + y // 5) % 2)[..., None] * np.ones(3))
    exact = Fft(bounces=bounces).solve(broken, None, {}).added.cloud[16:48, 16:48]
    technique = ThreeLevel(reading=reading, bounces=bounces)  # type: ignore[arg-type]
    found = technique.solve(broken, None, {}).added.cloud[16:48, 16:48]
    return float(np.sqrt(np.mean((found - exact) ** 2)) / exact.mean())


def test_distance_to_the_exact_kernel() -> None:
    """Under light in patches of 3H: nearest texels give blocks, taps and discs blur as the kernel does, or nearly."""
    found = {reading: distance(reading) for reading in READINGS}
    assert found["taps"] < 0.1
    assert found["discs"] < 0.1
    assert 0.1 < found["texels"] < 0.3


def test_the_readings_are_told_apart() -> None:
    weights = [ThreeLevel(reading=reading).numbers(4e4)["bounce_weights"] for reading in READINGS]  # type: ignore[arg-type]
    assert len({round(w[0], 3) for w in weights}) == 3
    for w in weights:
        assert sum(w) == pytest.approx(1)
