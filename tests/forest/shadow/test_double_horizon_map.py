"""Double horizon map: its weights by height, its threshold, and its distance to the reference."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.forest.shadow.double_horizon_map import DoubleHorizonMap
from renderer.forest.state import ForestState
from tests.forest import worlds
from tests.forest.horizons import EPS, threshold_error, twin, visibility
from tests.forest.truth import MARCH, Judge

Ask = Callable[..., np.ndarray]
FILE = "forest/shadow/double_horizon_map.glsl"
TOP, LOW = 10.0, 50.0
HEIGHTS = np.array([0.0, 0.25, 0.5, 0.625, 0.75, 0.9, 1.0])


def weight_error(ask: Ask, low: float = 0.5, top: float = 1.0) -> float:
    """Worst error over heights and suns against w = clamp((h - h_low)/(h_top - h_low), 0, 1) (errata 000-1)."""
    made = DoubleHorizonMap(softness=EPS, height_low=low, height_top=top)
    w = np.clip((HEIGHTS - low) / (top - low), 0, 1)
    gamma = w * TOP + (1 - w) * LOW
    worst = 0.0
    for elevation in (-2, 1, 10, 17, 30, 44, 50, 89):
        found = visibility(ask, made, elevation, h=HEIGHTS, canopy=(TOP, LOW))
        worst = max(worst, float(np.abs(found - twin(0, gamma, elevation, EPS)).max()))
    return worst


def test_half_light_falls_where_the_weights_say(ask: Ask) -> None:
    """At the sun's elevation Gamma half the light passes: LOW up to h = 0.5, the mean at 0.75, TOP at 1."""
    made = DoubleHorizonMap(softness=EPS, height_top=1.0, height_low=0.5)
    for h, gamma in ((0.0, LOW), (0.5, LOW), (0.75, (TOP + LOW) / 2), (1.0, TOP)):
        assert visibility(ask, made, gamma, h=h, canopy=(TOP, LOW))[0] == pytest.approx(0.5, abs=1e-5)


@pytest.mark.parametrize(("low", "top"), [(0.0, 1.0), (0.5, 1.0), (0.5, 0.75)])
def test_the_weights_are_the_twins(ask: Ask, low: float, top: float) -> None:
    assert weight_error(ask, low, top) < 1e-5


def test_a_top_map_below_the_low_one_breaks_nothing(ask: Ask) -> None:
    made = DoubleHorizonMap(softness=EPS, height_low=0.6, height_top=0.4)
    shares = visibility(ask, made, LOW, h=HEIGHTS, canopy=(TOP, LOW))
    np.testing.assert_allclose(shares, np.where(HEIGHTS <= 0.6, 0.5, 1.0), atol=1e-4)


@pytest.mark.parametrize(("right", "wrong"), [
    ("clamp((h - shadow_low) / (shadow_top - shadow_low), 0.0, 1.0)", "h"),  # the listing's: errata 000-1
    ("mix(low, canopy.r, w)", "mix(canopy.r, low, w)"),
    ("horizon_visibility(land, mix(", "horizon_visibility(land, 3.14159 * mix("),
])
def test_a_wrong_weight_is_found(ask: Ask, spoil: Callable, right: str, wrong: str) -> None:
    with spoil(FILE, right, wrong):
        assert weight_error(ask) > 0.05


def test_the_threshold_has_its_printed_values(ask: Ask) -> None:
    assert threshold_error(ask, DoubleHorizonMap(softness=EPS)) < 1e-5


def test_a_printed_threshold_is_found(ask: Ask, spoil: Callable) -> None:
    with spoil("forest/horizon_threshold.glsl", "smoothstep(gamma - eps, gamma + eps, phi)",
               "smoothstep(gamma, gamma + 2.0 * eps, phi)"):
        assert threshold_error(ask, DoubleHorizonMap(softness=EPS)) > 0.3


def test_light_grows_with_height_and_with_the_sun(ask: Ask) -> None:
    made = DoubleHorizonMap(softness=EPS)
    shares = np.array([visibility(ask, made, e, h=HEIGHTS, canopy=(TOP, LOW)) for e in (-1, 5, 12, 25, 40, 60)])
    assert ((shares >= 0) & (shares <= 1)).all()
    assert (np.diff(shares, axis=0) >= 0).all()
    assert (np.diff(shares, axis=1) >= 0).all()
    assert (shares[0] == 0).all(), "a sun below the horizon"


def test_the_terrain_hides_treetops_too(ask: Ask) -> None:
    made = DoubleHorizonMap(softness=EPS)
    assert visibility(ask, made, 20, h=1.0, terrain=40.0, canopy=(TOP, LOW))[0] == 0


def test_a_glade_knows_no_tile(ask: Ask) -> None:
    made = DoubleHorizonMap(softness=EPS)
    assert visibility(ask, made, 20, canopy=(TOP, LOW), cover=0.0)[0] == 1
    assert visibility(ask, made, 20, canopy=(TOP, LOW), cover=1.0)[0] == 0


VARIANT = {"floor_low": 90.0, "bound": 1.5}
"""Section 3.2's variant, in the place of empirical height shading."""


def variant_error(ask: Ask) -> float:
    """Worst error of the variant: the low layers dark under any sun, the tops half as bright again."""
    made = DoubleHorizonMap(softness=EPS, height_low=0.5, height_top=1.0, **VARIANT)
    w, worst = np.clip((HEIGHTS - 0.5) / 0.5, 0, 1), 0.0
    for elevation in (5, 30, 60, 83):
        found = visibility(ask, made, elevation, h=HEIGHTS, canopy=(TOP, LOW))
        worst = max(worst, float(np.abs(found - 1.5 * twin(0, w * TOP + (1 - w) * 90.0, elevation, EPS)).max()))
        glade = visibility(ask, made, elevation, canopy=(TOP, LOW), cover=0.0)
        worst = max(worst, float(np.abs(glade - twin(0, 0, elevation, EPS)).max()))
    return worst


def test_the_thesis_variant_keeps_the_lower_layers_dark_and_lights_the_tops(ask: Ask) -> None:
    assert variant_error(ask) < 1e-5


@pytest.mark.parametrize(("right", "wrong"), [
    ("max(canopy.g, shadow_floor_low * stand_here)", "canopy.g"),
    ("max(canopy.g, shadow_floor_low * stand_here)", "max(canopy.g, shadow_floor_low)"),
    ("mix(1.0, shadow_bound, stand_here)", "shadow_bound"), ("mix(1.0, shadow_bound, stand_here) *", ""),
])
def test_a_wrong_variant_is_found(ask: Ask, spoil: Callable, right: str, wrong: str) -> None:
    with spoil(FILE, right, wrong):
        assert variant_error(ask) > 0.1


def visible_at(made: DoubleHorizonMap, azimuth: float) -> np.ndarray:
    sectors = np.zeros((2, made.sectors, 1, 1), np.float32)
    sectors[0, 0], sectors[1, 0] = 0.2, 0.8
    bakes = {"terrain_horizon": {"sectors": sectors[0]}, "canopy_horizon": {"sectors": sectors}}
    state: ForestState = worlds.state(sun=worlds.sun(azimuth, 20))
    return made.frame_textures(state, bakes)["canopy"][0, 0]


def test_maps_go_round_the_azimuth_top_first() -> None:
    made = DoubleHorizonMap(sectors=8)
    for azimuth, share in ((0, 1.0), (22.5, 0.5), (45, 0.0), (180, 0.0), (337.5, 0.5), (359.999, 1.0)):
        np.testing.assert_allclose(visible_at(made, azimuth), share * np.array([0.2, 0.8]), atol=1e-4)


def test_the_frame_textures_change_with_azimuth_and_not_with_elevation() -> None:
    made = DoubleHorizonMap()
    first, higher, turned = (made.frame_key(worlds.state(sun=worlds.sun(*s))) for s in ((80, 20), (80, 40), (81, 20)))
    assert first == higher != turned


def test_distance_to_the_reference(judge: Judge) -> None:
    judge.holds(
        "shadow", "double_horizon_map",
        MARCH,
        0.445,  # one angle a sector: no gaps between and under crowns, and the neighbours are the atlas' own
        against="full",
    )


def test_no_shadow_is_farther_from_the_truth(judge: Judge) -> None:
    assert judge.distance("shadow", "none", "full") > 1.1 * (MARCH + 0.39)


def test_picture(judge: Judge) -> None:
    judge.looks("shadow", "double_horizon_map")
