"""Voxel transmittance: Beer and Lambert's law in an even canopy, its components, and its distance to the reference."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest

from renderer.forest.land_shadow import land_shadow
from renderer.forest.shadow.voxel_transmittance import VoxelTransmittance, kept_elevations
from renderer.forest.transmittance import (
    AZIMUTHS,
    ELEVATIONS,
    at_sun,
    bake_transmittance,
    extinction_of,
    transmittance,
)
from renderer.forest.world_scale import VOXEL
from tests.forest import worlds
from tests.forest.truth import MARCH, Judge

Ask = Callable[..., np.ndarray]
FILE = "forest/shadow/voxel_transmittance.glsl"
ALPHA = 6
TOP = 20 - 2 * VOXEL
"""Above the highest layer's centre [m] nothing is known but that layer's own."""


def scattered(seed: int = 3) -> dict[str, np.ndarray]:
    """A pattern of random boxes, small enough to bake in a moment."""
    rng = np.random.default_rng(seed)
    colour = np.zeros((16, 32, 32, 4), np.uint8)
    for _ in range(60):
        k, j, i = rng.integers(0, (12, 32, 32))
        colour[k : k + 3, j : j + 4, i : i + 4, 3] = rng.integers(20, 200)
    return {"colour_1": colour}


def baked(pattern: Any, coefficients: int) -> dict[str, np.ndarray]:
    return dict(bake_transmittance({"coefficients": coefficients}, {"pattern": pattern}, lambda share, words: None))


@cache
def even() -> dict[str, np.ndarray]:
    return baked(worlds.uniform(ALPHA), 8)


def seen(ask: Ask, sun: dict[str, Any], above: np.ndarray, *, slope: float = 0.0, cover: float = 1.0,
         **parameters: Any) -> np.ndarray:
    """Share of the sun at heights (N,) [m] in an even canopy, over ground that rises `slope` to the east."""
    made = VoxelTransmittance(**parameters)
    x = np.clip((np.arange(512) - 255.5) * 8, -100, 100)
    terrain = worlds.ground((x * slope + 100 * abs(slope))[None, :], cover)
    state = worlds.state(sun=sun)
    textures = made.frame_textures(state, {"transmittance": even(), "terrain": terrain})
    place = np.column_stack([np.full(above.shape, -50.0), 3 + 0 * above, above + 100 * abs(slope) - 50 * slope])
    return ask([FILE], "shadow_visibility(position, h, vec2(0.4, 0.7))", {"position": place, "h": above / 20},
               state=state, terrain=terrain, techniques={"shadow": made},
               textures={f"shadow_{name}": array for name, array in textures.items()})[:, 0]


def beer_error(ask: Ask, slope: float = 0.0) -> float:
    """Worst error over heights and suns against (1 - alpha)^(path / voxel), as a share of what is allowed there.

    The law is known at the baked elevations and read through the four kept ones: alone that costs up to 0.025. Between
    centres of layers, an optical depth d apart, a straight line errs by d^2 / 8; a byte's rounding and the filter's
    weights, of 8 bits, by half a byte each.
    """
    above = np.linspace(1.0, TOP, 24)
    extinction = -np.log1p(-float(worlds.uniform(ALPHA)["colour_1"][..., 3].max()) / 255) / (2 * VOXEL)
    table = np.exp(-extinction * (20 - above)[:, None] / np.sin(ELEVATIONS))
    worst = 0.0
    for elevation in (20.0, 41.0, 70.0):
        sun = np.radians(elevation)
        climb = np.tan(sun) - slope
        kept = kept_elevations(sun)
        place = 3 * np.log(np.arctan(climb) / kept[0]) / np.log(kept[3] / kept[0])
        known = np.array([np.interp(place, np.arange(4), np.interp(kept, ELEVATIONS, row)) for row in table])
        exact = known ** (1 / (np.cos(sun) * np.hypot(1, climb)))
        depth = extinction * 2 * VOXEL / np.sin(np.arctan(climb))
        found = seen(ask, worlds.sun(90, elevation), above, slope=slope)
        worst = max(worst, float(np.abs(found - exact).max()) / (1 / 255 + depth**2 / 8))
    return worst


@pytest.mark.parametrize("slope", [0.0, 0.2, -0.3])
def test_an_even_canopy_dims_as_beer_and_lambert_say(ask: Ask, slope: float) -> None:
    assert beer_error(ask, slope) < 1


@pytest.mark.parametrize(("right", "wrong"), [
    ("+ dot(normal.xy, sun_direction.xy)", "- dot(normal.xy, sun_direction.xy)"),
    ("clamp(3.0 * log(", "clamp(4.0 * log("),
    ("stand * stretched", "stand"),
    ("layered(vec3(uv, h),", "layered(vec3(uv, 0.5 * h),"),
])
def test_a_wrong_elevation_or_height_is_found(ask: Ask, spoil: Callable, right: str, wrong: str) -> None:
    with spoil(FILE, right, wrong):
        assert beer_error(ask, -0.3) > 3


def test_bare_ground_sees_the_sun_and_nothing_does_at_night(ask: Ask) -> None:
    above = np.linspace(0, TOP, 8)
    np.testing.assert_allclose(seen(ask, worlds.sun(40, 30), above, cover=0.0), 1, atol=1e-5)
    np.testing.assert_allclose(seen(ask, worlds.sun(40, 30), above, strength=0.0), 1, atol=1e-5)
    assert (seen(ask, worlds.sun(40, -4), above) == 0).all()


def test_all_components_give_back_the_table() -> None:
    pattern = scattered()
    full = baked(pattern, AZIMUTHS * len(ELEVATIONS))
    extinction, voxel = extinction_of(pattern["colour_1"][..., 3])
    for around, up in ((0, 3), (7, 9), (19, 5)):
        exact = transmittance(extinction, voxel, 2 * np.pi * around / AZIMUTHS, float(ELEVATIONS[up]))
        found = at_sun(full, 2 * np.pi * around / AZIMUTHS, ELEVATIONS[up : up + 1])[..., 0] / 255
        assert np.abs(found - exact).max() < 0.006
    assert float(full["residual"]) < 1e-3


def test_a_ray_s_transmittance_is_its_matter_s() -> None:
    """Straight up a lone column: the layers above, and half of the voxel's own."""
    opacity = np.zeros((8, 16, 16), np.uint8)
    opacity[2:5, 4, 7] = 100
    extinction, voxel = extinction_of(opacity)
    found = transmittance(extinction, voxel, 0.3, np.pi / 2 - 1e-7)[:, 4, 7]
    through = 1 - 100 / 255
    exact = through ** np.array([3, 3, 2.5, 1.5, 0.5, 0, 0, 0])
    np.testing.assert_allclose(found, exact, atol=1e-3)


def test_more_components_leave_out_less() -> None:
    pattern = scattered()
    left = [float(baked(pattern, count)["residual"]) for count in (1, 4, 16, 64)]
    assert left == sorted(left, reverse=True)
    assert left[-1] < 0.5 * left[0]


def test_the_residual_is_what_is_left_out() -> None:
    pattern = scattered()
    full, few = baked(pattern, AZIMUTHS * len(ELEVATIONS)), baked(pattern, 6)
    tables = [made["coefficients"] @ made["basis"].reshape(AZIMUTHS * len(ELEVATIONS), -1).T for made in (full, few)]
    assert np.sqrt(np.mean((tables[0] - tables[1]) ** 2)) == pytest.approx(float(few["residual"]), rel=0.02)


def test_frame_textures_follow_the_sun() -> None:
    made = VoxelTransmittance()
    keys = {made.frame_key(worlds.state(sun=worlds.sun(*sun))) for sun in ((80, 20), (80, 21), (81, 20), (80, 20))}
    assert len(keys) == 3
    assert (land_shadow(worlds.ground(), (1.0, 0.5)) <= 0).all()


def test_distance_to_the_reference(judge: Judge) -> None:
    judge.holds(
        "shadow", "voxel_transmittance",
        MARCH,
        0.256,  # voxels of 1.25 m, sixteen coefficients each, and the atlas' neighbours in the place of the map's
        against="full",
    )


def test_half_the_shadow_is_farther_from_the_truth(judge: Judge) -> None:
    half = {"shadow": worlds.technique("shadow", "voxel_transmittance", strength=0.5)}
    assert judge.distance("shadow", "voxel_transmittance", "full", **half) > 1.1 * (MARCH + 0.256)


def test_picture(judge: Judge) -> None:
    judge.looks("shadow", "voxel_transmittance")
