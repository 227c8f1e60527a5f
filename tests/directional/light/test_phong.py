"""Phong's model: the highlight's closed forms, a furnace that it does not exceed, GLSL against its twin."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.special import beta

from renderer.directional.brdf.models import phong
from renderer.directional.lamp import Lamp
from renderer.directional.light.phong import Phong
from renderer.gl.thread import GLThread
from tests.directional.light.points import COLOUR, SHADE, SKY, SUN, local, random_directions, shaded

LAMP = Lamp(lit=True, place=(0.4, -0.3, 1.5), intensity=500.0, colour=(1.0, 0.5, 0.25))


def twin(technique: Phong, normals: np.ndarray, to_eye: np.ndarray, sun: np.ndarray, openness: np.ndarray,
         lamp: Lamp | None = None, positions: np.ndarray | None = None) -> np.ndarray:
    """Radiance (N, 3) in float64."""
    ambient = COLOUR / np.pi * SKY * (openness * (1 + normals[:, 2]) / 2)[:, None] * technique.ambient
    sums = ambient + _of(technique, normals, to_eye, np.broadcast_to(sun, normals.shape), SUN)
    if lamp is not None and positions is not None:
        way = np.array(lamp.place) - positions
        far = np.linalg.norm(way, axis=1, keepdims=True)
        sums += _of(technique, normals, to_eye, way / far, lamp.intensity * np.array(lamp.colour) / far**2)
    return sums


def _of(t: Phong, normals: np.ndarray, to_eye: np.ndarray, towards: np.ndarray, arriving: np.ndarray) -> np.ndarray:
    view, light = local(normals, to_eye), local(normals, towards)
    lobe = phong(view, light, t.diffuse * COLOUR, t.specular, t.shininess)
    return np.asarray(lobe * arriving * SHADE * np.maximum(light[:, 2:], 0))


def drawn(thread: GLThread, lamp: Lamp | None = None) -> tuple[np.ndarray, np.ndarray]:
    """GLSL and twin at 1,000 points of all orientations."""
    technique = Phong(ambient=0.7, diffuse=0.6, specular=0.3, shininess=25.0)
    rng = np.random.default_rng(4)
    normals = random_directions(1000, 1)
    normals[::3] *= -1
    to_eye, sun = random_directions(1000, 2), random_directions(1, 3)[0]
    positions, openness = rng.uniform(-0.5, 0.5, (1000, 3)), rng.random(1000)
    found = shaded(thread, technique, {}, normals, to_eye, sun, lamp, positions, openness)
    return found, twin(technique, normals, to_eye, sun, openness, lamp, positions)


@pytest.mark.parametrize("lamp", [None, LAMP], ids=["sun", "sun and lamp"])
def test_glsl_equals_its_twin(thread: GLThread, lamp: Lamp | None) -> None:
    found, right = drawn(thread, lamp)
    np.testing.assert_allclose(found, right, rtol=2e-4, atol=0.02)  # W m-2 sr-1, of up to 2,000; pow in float32


@pytest.mark.parametrize(("right", "wrong"), [
    ("(shininess + 2.0)", "(shininess + 1.0)"),
    ("diffuse / PHONG_PI", "diffuse"),
    ("2.0 * dot(normal, light) * normal - light", "light"),
])  # fmt: skip
def test_a_spoiled_lobe_is_found(thread: GLThread, spoil: Callable, right: str, wrong: str) -> None:
    with spoil("directional/phong_lobe.glsl", right, wrong):
        found, exact = drawn(thread)
    assert not np.allclose(found, exact, rtol=2e-4, atol=0.02)


def albedo(cosine: float, specular: float, shininess: float, diffuse: float = 0.0) -> float:
    """Directional-hemispherical reflectance of the lobe, by product quadrature over the light's hemisphere."""
    x, w = np.polynomial.legendre.leggauss(100)
    z, turn = (x + 1) / 2, np.arange(200) * (2 * np.pi / 200)
    level = np.sqrt(1 - z * z)[:, None]
    light = np.stack(np.broadcast_arrays(level * np.cos(turn), level * np.sin(turn), z[:, None]), axis=-1)
    view = np.broadcast_to([np.sqrt(1 - cosine**2), 0, cosine], light.shape)
    values = phong(view, light, np.full(3, diffuse), specular, shininess)[..., 0]
    return float(((values * z[:, None]).mean(axis=1) * w / 2).sum() * 2 * np.pi)


@pytest.mark.parametrize("shininess", [1.0, 5.0, 40.0])
def test_the_furnace_in_closed_form(shininess: float) -> None:
    """All of the lobe's share at the normal; at level half a lobe, weighed by the sine: a Beta function."""
    assert albedo(1.0, 0.4, shininess) == pytest.approx(0.4, rel=1e-6)
    level = (shininess + 2) / (2 * np.pi) * beta((shininess + 1) / 2, 1.5)
    assert albedo(0.0, 1.0, shininess) == pytest.approx(level, rel=2e-4)


def test_no_energy_is_made() -> None:
    for shininess in (1.0, 100.0):
        for cosine in np.linspace(0.01, 1, 5):
            assert albedo(float(cosine), 0.5, shininess, 0.5) <= 1 + 1e-6


def test_the_printed_lobe_makes_energy() -> None:
    """Phong's own cos^n, without the factor (n + 2) / 2 pi, returns 2 pi / (n + 2) of the light: above 1 for n < 4."""
    assert albedo(1.0, 1.0, 1.0) * 2 * np.pi / 3 > 2


def test_light_and_eye_may_change_places() -> None:
    view, light = random_directions(500, 5), random_directions(500, 6)
    forth, back = (phong(*pair, COLOUR, 0.4, 12.0) for pair in ((view, light), (light, view)))
    np.testing.assert_allclose(forth, back, rtol=1e-12)
