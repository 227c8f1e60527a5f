"""Fourier opacity map: Beer and Lambert's law, the series and its ringing, and its distance to the reference."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from renderer.core.baking import bake_now
from renderer.core.cache import Cache
from renderer.forest.bakes import pattern_bake
from renderer.forest.shadow.fourier_opacity_map import FourierOpacityMap
from renderer.forest.state import ForestState
from renderer.forest.world_scale import CANOPY_HEIGHT, VOXEL
from tests.forest import worlds
from tests.forest.shadow.banks import stands_still_when_snapped
from tests.forest.shadow.opacities import by_series, by_sums, lines_through, rise, rms, series, table
from tests.forest.truth import MARCH, ROOT, Judge

Ask = Callable[..., np.ndarray]
KIND = "fourier_opacity_map"
FRAME = f"forest/shadow/{KIND}.glsl"
PASS = f"forest/shadow/{KIND}_waves.glsl"
TITLE = """# What few values keep of the light's way through the leaves

Root mean square error of the transmittance along 1,500 lines through the default forest's pattern, at three
elevations of the sun: over all places of the way, over those with matter, and over those by the light that they stop,
which is what a picture shows. The way runs from the first matter to the ground, or through the whole layer. What is
kept are a Fourier series of the extinction (Jansen & Bavoil 2010) or prefix sums of it at even distances. The last
column is by how much the transmittance rises again along its way in one line of a hundred: true light only falls. In
short, a series of 15 values errs less than 16 sums by the light they stop, but rings; damped, it no longer does, and
errs more.
`pytest -m slow --regenerate tests/forest/shadow` writes this.

"""
OPACITIES = ROOT / "docs/study/forest/shadow/opacities.md"
ALPHA = 6
SIDE = 24
"""Texels a side of the maps that are asked for; the window is as many times two metres."""

WINDOW = (-24.0, -24.0, 2.0, 2.0)
COST = 0.033
"""Texels of a third of a metre, and waves no shorter than a seventh of the crossing."""

TEXEL = """vec4 texels[1 + (SHADOW_COEFFICIENTS + 3) / 4];
shadow_waves_texel(pixel, texels);
for (int n = 0; n < 4 + 4 * ((SHADOW_COEFFICIENTS + 3) / 4); n++) result[n] = texels[n / 4][n % 4];"""


def around(made: FourierOpacityMap, sun: dict[str, Any]) -> dict[str, Any]:
    """Uniforms of a map around the middle of the land."""
    state = worlds.state(camera=worlds.map_view(0, 0, 40), sun=sun)
    drawn = made.sun_pass(state, {"terrain": worlds.ground()}, (64, 64))
    assert drawn is not None
    return {**drawn.uniforms, "shadow_window": WINDOW}


def drawn_map(ask: Ask, made: FourierOpacityMap, sun: dict[str, Any], **world: Any) -> dict[str, np.ndarray]:
    """What the pass puts into its textures, by sampler, (SIDE, SIDE, 4)."""
    along = np.arange(SIDE) + 0.5
    pixel = np.stack(np.meshgrid(along, along), axis=-1).reshape(-1, 2)
    count = 1 + -(-made.coefficients // 4)
    found = ask(
        [PASS],
        TEXEL,
        {"pixel": pixel},
        4 * count,
        state=worlds.state(sun=sun),
        values=around(made, sun),
        declarations=f"#define SHADOW_COEFFICIENTS {made.coefficients}",
        **world,
    ).reshape(SIDE, SIDE, count, 4)
    return {name: found[:, :, n] for n, name in enumerate(["span", *(f"waves_{k}" for k in range(count - 1))])}


def seen(
    ask: Ask,
    made: FourierOpacityMap,
    sun: dict[str, Any],
    position: np.ndarray,
    kept: dict[str, np.ndarray],
    **world: Any,
) -> np.ndarray:
    """Share of the sun that a map leaves at places (N, 3)."""
    state = worlds.state(sun=sun)
    ground = world.get("terrain") or worlds.ground()
    textures = {**kept, **made.frame_textures(state, {"terrain": ground})}
    return ask(
        [FRAME],
        "shadow_visibility(position, 0.0, vec2(0.0))",
        {"position": position},
        state=state,
        techniques={"shadow": made},
        textures={f"shadow_{name}": array for name, array in textures.items()},
        values={**around(made, sun), "sample_shift": 0.0},
        declarations=f"#define SHADOW_COEFFICIENTS {made.coefficients}",
        **world,
    )[:, 0]


def beer_error(ask: Ask, **parameters: Any) -> float:
    """Worst error, over heights and suns, of the mean share of the sun against (1 - alpha)^(path / voxel)."""
    rng = np.random.default_rng(2)
    made, world = FourierOpacityMap(**parameters), {"pattern": worlds.uniform(ALPHA)}
    worst = 0.0
    for elevation in (25.0, 50.0, 85.0):
        sun = worlds.sun(70, elevation)
        kept = drawn_map(ask, made, sun, **world)
        for above in (0.5, 6.0, 13.0, 19.5):
            places = np.column_stack([rng.uniform(-8, 8, (400, 2)), np.full(400, above)])
            found = seen(ask, made, sun, places, kept, **world)
            exact = (1 - ALPHA / 255) ** ((CANOPY_HEIGHT - above) / np.sin(np.radians(elevation)) / VOXEL)
            worst = max(worst, abs(float(found.mean()) - exact))
    return worst


@pytest.mark.parametrize("coefficients", [3, 9, 15])
def test_an_even_canopy_dims_as_beer_and_lambert_say(ask: Ask, coefficients: int) -> None:
    # Extinction is constant, so every wave is nothing; a quarter of a step of 2.5 m at either end.
    assert beer_error(ask, coefficients=coefficients) < 0.01


@pytest.mark.parametrize(
    ("file", "right", "wrong"),
    [
        (PASS, "vec2 wave = vec2(min(2.0 * depth,", "vec2 wave = vec2(min(depth,"),
        (FRAME, "clamp(span.x - sunward, 0.0", "clamp(span.x + 4.0 - sunward, 0.0"),
        (FRAME, "0.5 * waves.x * d", "waves.x * d * d"),
    ],
)
def test_a_wrong_depth_is_found(ask: Ask, spoil: Callable, file: str, right: str, wrong: str) -> None:
    with spoil(file, right, wrong):
        assert beer_error(ask) > 0.03


LEAFY = slice(16, 24)
"""Layers, of 32, that hold matter: from 10 m to 15 m above the ground."""


def layered_error(ask: Ask) -> float:
    """Worst error of the pass' coefficients, in shares of a_0, where only some layers hold matter.

    Closed form: the light first meets matter at their top; they take up a third of its way to the ground, so that
    a_k / a_0 is the mean of cos(2 pi k d) over d from 0 to 1/3, b_k / a_0 that of the sine.
    """
    sun, made = worlds.sun(70, 50), FourierOpacityMap(level=-3)
    kept = drawn_map(ask, made, sun, pattern=worlds.uniform(ALPHA, layers=LEAFY))
    values = np.concatenate([kept[f"waves_{n}"] for n in range(4)], axis=-1)[..., :15].mean(axis=(0, 1))
    k = 2 * np.pi * np.arange(1, 8)
    exact = np.stack([np.sin(k / 3), 1 - np.cos(k / 3)], axis=1).ravel() / (k / 3).repeat(2)
    a_0 = -2 * np.log(1 - ALPHA / 255) * 5 / VOXEL / np.sin(np.radians(50))
    assert values[0] == pytest.approx(a_0, rel=0.03)
    return float(np.abs(values[1:] / values[0] - exact).max())


def test_the_pass_gathers_what_the_paper_says(ask: Ask) -> None:
    # Steps of 0.6 m begin anywhere in a way of 19 m, of which the shortest wave is a seventh.
    assert layered_error(ask) < 0.02


def test_waves_of_the_wrong_length_are_found(ask: Ask, spoil: Callable) -> None:
    with spoil(PASS, "cos(6.283185307179586 * d)", "cos(5.5 * d)"):
        assert layered_error(ask) > 0.12


@pytest.mark.parametrize(("coefficients", "damping"), [(3, 0.0), (7, 1.0), (9, 0.0), (13, 0.5), (15, 0.0), (15, 1.0)])
def test_the_series_is_summed_as_the_paper_says(ask: Ask, coefficients: int, damping: float) -> None:
    """Twin: T = exp(-tau(d)), tau from numpy, over two crossings of the canopy with air between them."""
    rng = np.random.default_rng(8)
    values = np.concatenate([[4.0], rng.uniform(-1, 1, coefficients - 1)])
    padded = np.concatenate([values, np.zeros(-coefficients % 4)]).reshape(-1, 4)
    kept = {f"waves_{n}": np.broadcast_to(four, (SIDE, SIDE, 4)) for n, four in enumerate(padded)}
    kept["span"] = np.broadcast_to(np.array([40.0, 32.0, 20.0, 8.0]), (SIDE, SIDE, 4))
    height = np.linspace(0.5, 45, 200)
    way = np.clip(40 - height, 0, 8) + np.clip(20 - height, 0, 12)
    made = FourierOpacityMap(coefficients=coefficients, damping=damping, strength=0.9)
    found = seen(ask, made, worlds.sun(0, 90), np.column_stack([0 * height, 0 * height, height]), kept)
    exact = 0.1 + 0.9 * np.exp(-np.maximum(series(values[None], way / 20, damping)[0], 0))
    np.testing.assert_allclose(found, exact, atol=1e-4)


def test_ringing_is_bounded_and_damping_does_not_pay() -> None:
    """Over dense crowns on opaque trunks: light lies in [0, 1] and rises again by little, but damping errs more."""
    lines = lines_through(worlds.grove_pattern({}, {}, lambda share, words: None), 18.0, 400)
    fifteen, damped = by_series(lines, 15), by_series(lines, 15, 1.0)
    assert 0 <= fifteen.min() <= fifteen.max() <= 1
    assert rise(fifteen) < 0.2
    assert rise(damped) < 0.05
    assert rms(lines, fifteen, "light") < 0.9 * rms(lines, damped, "light")
    assert rms(lines, fifteen, "light") < 0.75 * rms(lines, by_series(lines, 7), "light")


@pytest.mark.slow
def test_in_the_default_forest_a_series_errs_less_than_sums(pytestconfig: pytest.Config) -> None:
    """The choice of the series, by the light that is stopped; its table is what the default forest gives."""
    pattern = bake_now(pattern_bake(ForestState()), Cache())
    for elevation in (18.0, 38.0):
        lines = lines_through(pattern, elevation)
        assert rms(lines, by_series(lines, 15), "light") < 0.95 * rms(lines, by_sums(lines, 16), "light")
    if pytestconfig.getoption("--regenerate"):
        OPACITIES.write_text(TITLE + table(pattern), encoding="utf-8")
    assert OPACITIES.read_text(encoding="utf-8") == TITLE + table(pattern)


def test_no_sun_below_the_horizon_and_no_shadow_without_strength(ask: Ask) -> None:
    places = np.array([[0.0, 0.0, 0.5], [3.0, 4.0, 4.0]])
    thick = {"pattern": worlds.uniform(60)}
    kept = drawn_map(ask, FourierOpacityMap(), worlds.sun(270, 50), **thick)
    assert seen(ask, FourierOpacityMap(), worlds.sun(270, 50), places, kept, **thick).max() < 0.01
    np.testing.assert_allclose(
        seen(ask, FourierOpacityMap(strength=0.0), worlds.sun(270, 50), places, kept, **thick), 1
    )
    night = drawn_map(ask, FourierOpacityMap(), worlds.sun(270, -3), **thick)
    assert (seen(ask, FourierOpacityMap(), worlds.sun(270, -3), places, night, **thick) == 0).all()


def test_a_snapped_map_keeps_its_texels_while_the_camera_moves() -> None:
    stands_still_when_snapped(FourierOpacityMap)


def test_distance_to_the_reference(judge: Judge) -> None:
    """Less than half of what one depth a texel errs on the same view, with as many texels."""
    judge.holds("shadow", KIND, MARCH, COST, against="full")
    one_depth = {"shadow": worlds.technique("shadow", "depth_shadow_map", resolution=512)}
    assert judge.distance("shadow", "depth_shadow_map", "full", **one_depth) > 2.2 * (MARCH + COST)


def test_fewer_waves_cost_more(judge: Judge) -> None:
    short = {"shadow": worlds.technique("shadow", KIND, coefficients=3)}
    assert judge.distance("shadow", KIND, "full", **short) > 1.4 * (MARCH + COST)


def test_picture(judge: Judge) -> None:
    judge.looks("shadow", KIND)
