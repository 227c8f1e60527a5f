"""The truth of bounced light: closed forms, and its two ways against each other."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.core.errors import InputError
from renderer.reference import cloud_radiosity
from renderer.reference.cloud_radiosity import Scene, Solution, by_quadrature, by_rays

N = 32


def scene(elevation: np.ndarray | None = None, half: float = 8.0, ground: float = 0.3, cloud: float = 0.9) -> Scene:
    ones = np.ones((N, N))
    flat = np.zeros((N + 1, N + 1)) if elevation is None else elevation
    return Scene(half, flat, ground * ones, cloud * ones, 0 * ones, ones)


def rms(field: np.ndarray) -> float:
    return float(np.sqrt(np.mean(field**2)))


def test_one_half_bounce_is_the_squares_form_factor() -> None:
    """A black cloud: the ground has what the square above its middle sends, nearly that of the whole square."""
    found = by_quadrature(scene(cloud=0.0))
    corner = np.arctan(8 / np.sqrt(65)) * 8 / np.sqrt(65) * 2 / np.pi * 2
    middle = found.ground[N // 2 - 1 : N // 2 + 1, N // 2 - 1 : N // 2 + 1].mean()
    assert middle == pytest.approx(0.3 * corner, rel=1e-3)
    assert (found.cloud == 1).all()


@pytest.fixture(scope="module")
def pair() -> tuple[Solution, Solution]:
    return by_quadrature(scene()), by_rays(scene(), 512)


def test_rays_and_quadrature_agree_within_the_stated_error(pair: tuple[Solution, Solution]) -> None:
    exact, cast = pair
    assert exact.ground_error.max() < 1e-5
    for found, right, error in (
        (cast.ground, exact.ground, cast.ground_error),
        (cast.cloud, exact.cloud, cast.cloud_error),
    ):
        assert rms(found - right) < 1.5 * rms(error)
        assert abs(np.mean(found - right)) < 1e-3
        assert rms(error) < 0.01 * right.mean()


def test_a_brighter_ground_is_found(pair: tuple[Solution, Solution]) -> None:
    exact = by_quadrature(scene(ground=0.31))
    assert rms(pair[1].ground - exact.ground) > 3 * rms(pair[1].ground_error)


def test_a_wall_all_round_hides_its_share_of_the_cloud() -> None:
    """Nearly black ground in a round pit: its middle sees all but sin^2 of the wall's elevation (errata 001-21)."""
    places = np.hypot(*np.meshgrid(*[np.linspace(-8, 8, N + 1)] * 2))
    pit = scene(np.where(places > 2.2, 0.8, 0.0), ground=1e-4, cloud=0.0)
    found = by_rays(pit, 2048).ground[N // 2 - 1 : N // 2 + 1, N // 2 - 1 : N // 2 + 1].mean() * 1e4
    hidden = [np.sin(np.arctan(0.8 / radius)) ** 2 for radius in (2.7, 2.2)]
    assert 1 - 1 / 65 - hidden[1] < found < 1 - hidden[0]
    open_land = by_rays(scene(ground=1e-4, cloud=0.0), 2048).ground[N // 2, N // 2] * 1e4
    assert open_land > found + 0.07


def test_walls_light_the_middle_of_a_pit() -> None:
    places = np.hypot(*np.meshgrid(*[np.linspace(-8, 8, N + 1)] * 2))
    walls = np.where(places > 2.2, 0.8, 0.0)
    middle = (N // 2, N // 2)
    dark, bright = (
        by_rays(scene(walls, ground=albedo, cloud=0.0), 512).ground[middle] / albedo for albedo in (1e-4, 0.5)
    )
    assert bright > dark + 0.02


def test_ground_over_the_base_is_refused() -> None:
    with pytest.raises(InputError, match="elevation"):
        by_rays(scene(np.full((N + 1, N + 1), 1.0)))
    with pytest.raises(InputError, match="level"):
        by_quadrature(scene(np.full((N + 1, N + 1), 0.5)))


def test_bounces_without_end_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cloud_radiosity, "MOST", 20)
    with pytest.raises(InputError, match="bounces"):
        by_quadrature(scene(ground=1.0, cloud=1.0))
