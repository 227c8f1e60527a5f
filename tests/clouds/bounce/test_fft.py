"""The exact kernel: endless planes, light that it spreads, its shader, the truth, and what it is blind to."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.clouds.bounce.fft import Fft
from renderer.clouds.radiosity.bases import CELL, GRID, HALF
from renderer.clouds.radiosity.flat import bounce
from renderer.clouds.radiosity.form_factors import rectangle
from renderer.clouds.radiosity.kernel import flat_exchange
from renderer.clouds.radiosity.maps import uniform_gain
from renderer.reference.cloud_radiosity import Scene, by_quadrature
from tests.clouds.bounce.conftest import HEIGHT, Shown, maps, middles, uneven

EVEN = 200 * 0.18 / (1 - 0.18)
GLSL = "clouds/bounce/fft.glsl"


def test_even_planes_give_the_closed_sum() -> None:
    found = Fft().solve(maps(), None, {}).added
    np.testing.assert_allclose(found.ground, EVEN, rtol=1e-4)
    np.testing.assert_allclose(found.cloud, 200 * 0.3 * uniform_gain(np.array(0.3), np.array(0.6)), rtol=1e-4)


def test_snow_under_thick_cloud_needs_the_tail() -> None:
    snow = maps(albedo=np.full((GRID, GRID, 3), 0.9), reflectance=np.full((GRID, GRID), 0.9))
    exact = 200 * 0.81 / 0.19
    assert Fft().solve(snow, None, {}).added.ground.mean() == pytest.approx(exact, rel=1e-3)
    cut = Fft(tail=False).solve(snow, None, {}).added.ground.mean()
    assert 1 - cut / exact == pytest.approx(0.81**4, rel=1e-3), "of what is added; errata 001-10"


def test_light_under_the_layer_starts_at_the_base() -> None:
    """The sun below the clouds: the ground has light only by their reflection."""
    dark = np.zeros((GRID, GRID, 3))
    found = Fft().solve(maps(ground=dark, cloud=dark + 100, albedo=dark), None, {}).added
    np.testing.assert_allclose(found.ground, 60, rtol=1e-5)
    glowing = Fft().solve(maps(ground=dark, emitted=dark + 50, albedo=dark), None, {}).added
    np.testing.assert_allclose(glowing.ground, 50, rtol=1e-5)


def test_one_bright_field_lights_the_clouds_as_its_form_factor() -> None:
    snow = np.zeros((GRID, GRID, 3))
    snow[28:36, 28:36] = 1
    found = Fft(bounces=1).solve(maps(albedo=snow, reflectance=0 * snow), None, {}).added.cloud[31, 31, 0]
    exact = 200 * float(rectangle((-1.75, 2.25), (-1.75, 2.25)))
    # What lies beyond the square has its mean: 1/64 of the light, where the square does not fill the hemisphere.
    assert found == pytest.approx(exact, rel=3e-3)


def shader_error(shown: Shown, reference: object = None) -> float:
    """Worst distance of the shader from the maps, over the mean."""
    solved = Fft().solve(uneven(), None, {})
    places, (rows, columns) = middles()
    worst = 0.0
    for found, field in zip(shown(Fft(), None, solved, places), (solved.added.ground, solved.added.cloud), strict=True):
        worst = max(worst, float(np.abs(found - field[rows, columns]).max() / field.mean()))
    return worst


def test_the_shader_reads_what_was_solved(shown: Shown) -> None:
    assert shader_error(shown) < 1e-5


@pytest.mark.parametrize(
    ("file", "right", "wrong"),
    [
        (GLSL, "textureLod(bounce_ground_map, at * 0.5 + 0.5", "textureLod(bounce_ground_map, at * 0.5 + 0.51"),
        (GLSL, "textureLod(bounce_cloud_map, at * 0.5 + 0.5", "textureLod(bounce_cloud_map, at.yx * 0.5 + 0.5"),
        ("clouds/bounce_square.glsl", "return (place - bounce_centre)", "return 1.1 * (place - bounce_centre)"),
    ],
)
def test_a_wrong_place_is_found(shown: Shown, spoil: Callable, file: str, right: str, wrong: str) -> None:
    with spoil(file, right, wrong):
        assert shader_error(shown) > 1e-2


def test_beyond_the_square_planes_are_even(shown: Shown) -> None:
    solved = Fft().solve(maps(ground=np.zeros((GRID, GRID, 3))), None, {})
    far = HALF * HEIGHT
    ground, cloud = shown(Fft(), None, solved, np.array([[0.0, 0.0], [0.8 * far, 0.0], [far, 0.0], [-9e6, 3e6]]))
    assert ground[0] == pytest.approx(0, abs=1e-6)
    assert 0 < ground[1, 0] < EVEN
    np.testing.assert_allclose(ground[2:], EVEN, rtol=1e-5)
    np.testing.assert_allclose(cloud[2:], 200 * 0.3 / (1 - 0.18), rtol=1e-5)


def test_the_square_may_lie_anywhere(shown: Shown) -> None:
    given = uneven()
    moved = type(given)(**{**vars(given), "centre": (70_000.0, -30_000.0)})
    one, other = Fft().solve(given, None, {}), Fft().solve(moved, None, {})
    places = middles()[0][::40]
    there = shown(Fft(), None, other, places + np.array([70_000.0, -30_000.0]))
    np.testing.assert_allclose(there[0], shown(Fft(), None, one, places)[0], rtol=1e-3)


def truth_error(shift: int = 0) -> float:
    """Relative RMSE of the ground's light under a square cloud against the quadrature, over the render square."""
    square = np.zeros((GRID, GRID))
    square[GRID // 4 : 3 * GRID // 4, GRID // 4 + shift : 3 * GRID // 4 + shift] = 1
    one = np.ones((GRID, GRID))
    exact = by_quadrature(Scene(HALF, np.zeros((GRID + 1, GRID + 1)), 0.3 * one, 0.9 * one, 0 * one, square)).ground
    found = (
        0.3
        * bounce(
            flat_exchange(GRID, CELL, points=True), 0 * one[None], square[None], 0.3 * one[None], 0.9 * one[None], 40
        )[0][0]
    )
    inner = (slice(GRID // 4, 3 * GRID // 4),) * 2
    return float(np.sqrt(np.mean((found - exact)[inner] ** 2)) / exact[inner].mean())


def test_distance_to_the_reference() -> None:
    assert truth_error() < 1e-4
    square = np.zeros((1, GRID, GRID))
    square[:, 16:48, 16:48] = 1
    wrong = flat_exchange(GRID, 1.2 * CELL, points=True)(square)
    right = flat_exchange(GRID, CELL, points=True)(square)
    assert np.abs(wrong - right).max() > 0.05, "another height is found"
