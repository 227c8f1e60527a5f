"""Single horizon map: its threshold, its two parts, its azimuths, and its distance to the reference."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.forest.horizon_textures import at_azimuth
from renderer.forest.shadow.horizon_map import HorizonMap
from tests.forest import worlds
from tests.forest.horizons import EPS, threshold_error, twin, visibility
from tests.forest.truth import MARCH, Judge

Ask = Callable[..., np.ndarray]
FILE = "forest/horizon_threshold.glsl"
MAP = HorizonMap(softness=EPS)


def test_the_threshold_has_its_printed_values(ask: Ask) -> None:
    assert threshold_error(ask, MAP) < 1e-5


@pytest.mark.parametrize(("right", "wrong"), [
    # As the thesis prints it, t = (phi - Gamma) / (2 eps): errata 000-2.
    ("smoothstep(gamma - eps, gamma + eps, phi)", "smoothstep(gamma, gamma + 2.0 * eps, phi)"),
    ("smoothstep(gamma - eps, gamma + eps, phi)", "1.0 - smoothstep(gamma - eps, gamma + eps, phi)"),
    ("smoothstep(gamma - eps, gamma + eps, phi)", "smoothstep(gamma - eps, gamma + eps, 1.5707963 - phi)"),
])
def test_a_wrong_threshold_is_found(ask: Ask, spoil: Callable, right: str, wrong: str) -> None:
    with spoil(FILE, right, wrong):
        assert threshold_error(ask, MAP) > 0.1


def twin_error(ask: Ask) -> float:
    """Worst error against the twin, over suns, horizons of both parts, open and wooded places."""
    worst = 0.0
    for elevation in (-3.0, 0.5, 4.0, 20.0, 33.0, 80.0):
        for terrain, canopy, cover in ((0, 0, 1), (5, 18, 1), (35, 30, 1), (5, 18, 0), (35, 30, 0)):
            found = visibility(ask, MAP, elevation, terrain=terrain, canopy=(70, canopy), cover=cover)
            worst = max(worst, float(np.abs(found - twin(terrain, canopy * cover, elevation, EPS)).max()))
    return worst


def test_land_and_trees_hide_the_sun_and_trees_only_where_they_stand(ask: Ask) -> None:
    assert twin_error(ask) < 1e-5


@pytest.mark.parametrize(("right", "wrong"), [
    ("* stand_towards_sun(position.xy)", ""), ("return horizon_visibility(", "return 1.0 - horizon_visibility("),
])
def test_a_wrong_choice_of_horizon_is_found(ask: Ask, spoil: Callable, right: str, wrong: str) -> None:
    with spoil("forest/shadow/horizon_map.glsl", right, wrong):
        assert twin_error(ask) > 0.1


def test_light_only_grows_with_the_sun_and_none_comes_from_below(ask: Ask) -> None:
    shares = [float(visibility(ask, MAP, e, terrain=2.0)[0]) for e in (-8, -0.1, 0.1, 2, 5, 8.5, 40, 90)]
    assert shares == sorted(shares)
    assert shares[0] == shares[1] == 0
    assert shares[-1] == 1


def test_strength_blends_the_trees_to_no_shadow(ask: Ask) -> None:
    for strength in (0.0, 0.25, 1.0):
        made = HorizonMap(softness=EPS, strength=strength)
        assert visibility(ask, made, 10.0, canopy=(0, 50))[0] == pytest.approx(1 - strength)
        assert visibility(ask, made, 10.0, terrain=50.0)[0] == 0, "land lets no light through, whatever the strength"


RNG = np.random.default_rng(8)


@pytest.mark.parametrize("sectors", [4, 8, 32])
def test_azimuth_is_interpolated_linearly_and_goes_round(sectors: int) -> None:
    """Twin: numpy's own periodic interpolation, in float64."""
    maps = RNG.uniform(0, 1, (sectors, 3)).astype(np.float32)
    axes = 2 * np.pi * np.arange(sectors + 1) / sectors
    for azimuth in (*RNG.uniform(-7, 13, 40), 0.0, axes[1], axes[-1], axes[-1] - 1e-9):
        exact = [np.interp(azimuth % (2 * np.pi), axes, np.append(column, column[0])) for column in maps.T]
        np.testing.assert_allclose(at_azimuth(maps, azimuth), exact, atol=1e-5)


def test_the_map_of_the_technique_looks_towards_the_sun() -> None:
    """A wall in the north hides a northern sun; textures have their first row in the south."""
    north = np.zeros((4, 3, 2), np.float32)
    north[0] = [[0.3, 0.3], [0.2, 0.2], [0.1, 0.1]]  # rows from the northern edge on
    bakes = {"terrain_horizon": {"sectors": north}, "canopy_horizon": {"sectors": np.zeros((1, 4, 2, 2), np.float32)}}
    for azimuth, share in ((0, 1.0), (45, 0.5), (90, 0.0), (180, 0.0), (315, 0.5)):
        found = MAP.frame_textures(worlds.state(sun=worlds.sun(azimuth, 20)), bakes)["terrain"]
        np.testing.assert_allclose(found[:, 0], share * np.array([0.1, 0.2, 0.3]), atol=1e-6)


def test_distance_to_the_reference(judge: Judge) -> None:
    judge.holds(
        "shadow", "horizon_map",
        MARCH,
        0.445,  # one angle a sector: no gaps between and under crowns, and the neighbours are the atlas' own
        0.095,  # one height for the whole canopy
        against="full",
    )


def test_a_sun_from_behind_is_found(judge: Judge) -> None:
    """The truth of one sun rejects the shadows of the opposite one."""
    behind = judge.distance("shadow", "depth_shadow_map", "full", sun=worlds.sun(65, 33))
    assert behind > 1.1 * (MARCH + 0.39 + 0.11)


def test_picture(judge: Judge) -> None:
    judge.looks("shadow", "horizon_map")
