"""Every preset shows what it is named for."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from renderer import view
from renderer.clouds.presets import PRESETS
from renderer.clouds.state import CloudsState
from renderer.core.baking import bake_key, bake_now
from renderer.core.cache import Cache
from renderer.core.params import merge, validate
from renderer.core.registry import phenomena
from renderer.core.technique import BakedArrays
from renderer.gl.thread import GLThread
from renderer.world.camera import rays
from renderer.world.sun import direction

SIZE = (60, 40)
NEAR = ("silver_lining", "valley", "sea_of_clouds", "snow_stratus")
"""Seen from under or within the layer, which the weather of the whole Earth leaves closed and takes longest to draw."""
KEPT: dict[str, BakedArrays] = {}

Shown = Callable[..., tuple[CloudsState, np.ndarray]]


def _baked(bake: Any) -> BakedArrays:
    key = bake_key(bake)
    if key not in KEPT:
        KEPT[key] = BakedArrays(key, bake_now(bake, Cache()))
    return KEPT[key]


@pytest.fixture(scope="module")
def painter(thread: GLThread) -> view.Painter:
    """The scene's renderer and the display pass; the thread releases them."""
    return view.Painter(thread)


@pytest.fixture(scope="module")
def shown(thread: GLThread, painter: view.Painter) -> Shown:
    """A preset's state and its picture, (40, 60, 3) W m-2 sr-1, with what else is patched."""

    def draw(name: str, **patch: Any) -> tuple[CloudsState, np.ndarray]:
        document = merge(CloudsState().model_dump(mode="json"), PRESETS[name].patch)
        if name in NEAR:
            document = merge(document, {"clouds": {"systems": False}})
        document = merge(document, patch)
        state = validate(CloudsState, document)
        baked = {bake.name: _baked(bake) for bake in phenomena()["clouds"].bakes(state)}
        found = view.paint(thread, painter, state, baked, SIZE, 2).linear
        assert np.isfinite(found).all()
        return state, found[..., :3].astype(float)

    return draw


def from_antisolar(state: CloudsState) -> np.ndarray:
    """Angle of every pixel from the point opposite the sun, degrees, (40, 60)."""
    _, directions = rays(state.camera, *SIZE)
    return np.degrees(np.arccos(np.clip(-(directions @ direction(state.sun)), -1, 1)))


def ring(picture: np.ndarray, away: np.ndarray, low: float, high: float) -> float:
    """Mean green light of the pixels so far from the antisolar point, below the horizon."""
    return float(picture[..., 1][(away >= low) & (away < high) & (np.arange(SIZE[1])[:, None] > 18)].mean())


def test_the_fogbow_stands_38_degrees_from_the_antisolar_point_and_needs_true_droplets(shown: Shown) -> None:
    def contrast(**patch: Any) -> float:
        state, picture = shown("fogbow", **patch)
        away = from_antisolar(state)
        return 2 * ring(picture, away, 36, 41) / (ring(picture, away, 25, 30) + ring(picture, away, 46, 51))

    even = {"kind": "uniform"}
    assert contrast(clouds=even) > 1.1
    assert contrast(clouds=even, phase={"kind": "henyey_greenstein"}) < 1.03


def test_the_glory_lies_round_the_antisolar_point_in_colours(shown: Shown) -> None:
    state, picture = shown("glory", clouds={"kind": "uniform"})
    away = from_antisolar(state)
    warmth = picture[..., 0] / picture[..., 2]
    inside, outside = warmth[away < 3.0], warmth[away > 7.0]
    assert np.ptp(inside) > 3 * np.ptp(outside)


def test_the_base_is_lit_red_from_below_by_a_sun_that_has_set(shown: Shown) -> None:
    _, low = shown("sunset_below")
    _, gone = shown("sunset_below", sun={"elevation": -6.0})
    sky = low[14:22].mean(axis=(0, 1))
    assert sky[0] > 2.0 * sky[2]
    assert low[:14].mean() > 20 * gone[:14].mean()


def test_a_layer_without_end_hides_a_sun_that_has_set(shown: Shown, spoil: Callable) -> None:
    """The sun's way to the base and to the air under it leads through the layer far away: what is left is the sky's."""

    def closed() -> np.ndarray:
        return shown("sunset_below", layer={"ends": 0.0})[1][:14].mean(axis=(0, 1))

    front, hidden = shown("sunset_below")[1][:14].mean(axis=(0, 1)), closed()
    assert front[0] > 2.0 * front[2], "red from beyond the front"
    assert hidden[0] < 1.2 * hidden[2]
    assert hidden[0] < 0.45 * front[0]
    right, wrong = "return exp(-min(layer_extinction * slant, GAPS)", "return exp(-0.0 * (slant + GAPS)"
    with spoil("clouds/cloud.glsl", right, wrong):
        assert closed()[0] > 2 * hidden[0]


def test_a_level_layer_under_a_grazing_sun_has_its_cosine_s_light(shown: Shown, spoil: Callable) -> None:
    """Its top has no swells round which light could leak; seen from above before sunset it was twice too bright."""
    even = {"clouds": {"kind": "uniform"}, "phase": {"kind": "henyey_greenstein"}, "bounce": {"kind": "none"}}

    def growth() -> float:
        return float(shown("glory", sun={"elevation": 6.0}, **even)[1].mean()) / float(
            shown("glory", sun={"elevation": 1.0}, **even)[1].mean()
        )

    assert growth() > 4.2
    with spoil("clouds/cloud.glsl", "leak = min(SWELL_SHADE, layer_relief * length(s.slope))", "leak = SWELL_SHADE"):
        assert growth() < 4.0


def test_the_clouds_edge_before_the_sun_outshines_its_middle(shown: Shown) -> None:
    _, picture = shown("silver_lining")
    light = picture.mean(axis=2)
    assert np.percentile(light, 98) > 3 * np.median(light)
    _, closed = shown("silver_lining", clouds={"kind": "uniform"})
    assert np.percentile(closed, 98) < 2 * np.median(closed)


def test_snow_and_clouds_send_light_to_and_fro(shown: Shown) -> None:
    _, lit = shown("snow_stratus")
    _, once = shown("snow_stratus", bounce={"kind": "none"})
    _, bare = shown("snow_stratus", planet={"snow_line": 9000.0})
    assert lit[:12].mean() > 1.2 * once[:12].mean(), "the base, by light from below"
    assert lit[:12].mean() > 1.1 * bare[:12].mean(), "brighter over snow than over grass"


def test_clouds_shade_the_valley(shown: Shown) -> None:
    _, shaded = shown("valley")
    _, clear = shown("valley", cloud_shadow={"kind": "none"})
    darker = shaded[18:].mean(axis=2) / clear[18:].mean(axis=2)
    assert 0.1 < (darker < 0.7).mean() < 0.5, "patches of shadow, no more and no less"


def test_gaps_that_are_wide_enough_to_be_seen_stay_open_far_away(shown: Shown, spoil: Callable) -> None:
    def blue(time: float) -> float:
        sky = shown("valley", time=time)[1][:10]
        return float((sky[..., 2] > 1.3 * sky[..., 0]).mean())

    seen = blue(0.0)
    right, wrong = "footprint * t * inversesqrt(clamp(abs(cosine), 0.1, 1.0))", "footprint * t / max(abs(cosine), 0.1)"
    with spoil("clouds/stretch.glsl", right, wrong):
        assert seen > 1.2 * blue(1.0), "a second later, as what was traced at the first moment is kept"


def test_summits_stand_in_the_sun_above_the_layer(shown: Shown) -> None:
    _, above = shown("sea_of_clouds")
    _, under = shown("sea_of_clouds", layer={"base": 3500.0})
    assert above[14:22].max() > 3 * under[14:22].max()


@pytest.mark.parametrize("name", ["space", "limb"])
def test_the_planet_hangs_in_the_dark(shown: Shown, name: str) -> None:
    _, picture = shown(name)
    assert picture[0, 0].max() == 0
    assert picture[..., 2].max() > 30
    rim = picture[picture[..., 2] > 0]
    assert (rim[:, 2] > rim[:, 0]).mean() > 0.5, "air is blue"


@pytest.mark.parametrize("name", PRESETS)
def test_a_preset_is_titled_and_valid(name: str) -> None:
    preset = PRESETS[name]
    assert preset.title
    assert preset.help.endswith(".")
    validate(CloudsState, merge(CloudsState().model_dump(mode="json"), preset.patch))
