"""Fourier opacity map: Beer and Lambert's law, the series and its ringing, and its distance to the reference."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from renderer.forest.shadow.fourier_opacity_map import FourierOpacityMap
from renderer.forest.world_scale import CANOPY_HEIGHT, VOXEL
from tests.forest import worlds
from tests.forest.truth import MARCH, Judge

Ask = Callable[..., np.ndarray]
KIND = "fourier_opacity_map"
FRAME = f"forest/shadow/{KIND}.glsl"
PASS = f"forest/shadow/{KIND}_waves.glsl"
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
        (PASS, "vec2 wave = vec2(2.0 * depth, 0.0);", "vec2 wave = vec2(depth, 0.0);"),
        (FRAME, "clamp(span.x - sunward, 0.0", "clamp(span.x + 4.0 - sunward, 0.0"),
        (FRAME, "0.5 * waves.x * d", "waves.x * d * d"),
    ],
)
def test_a_wrong_depth_is_found(ask: Ask, spoil: Callable, file: str, right: str, wrong: str) -> None:
    with spoil(file, right, wrong):
        assert beer_error(ask) > 0.03


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
    def corner(x: float, snapping: bool) -> np.ndarray:
        made = worlds.state(camera=worlds.map_view(x, -50, 60), sun=worlds.sun(200, 40))
        found = FourierOpacityMap(snapping=snapping).sun_pass(made, {"terrain": worlds.ground()}, (64, 64))
        assert found is not None
        low, side = np.split(np.array(found.uniforms["shadow_window"]), 2)
        return np.asarray(low / side % 1)

    assert np.abs(corner(100.0, True) - corner(100.37, True)).max() < 1e-6
    assert np.abs(corner(100.0, False) - corner(100.37, False)).max() > 0.01


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
