"""Maps of first light: closed forms of an even layer over level ground, the layer's drift, snow, shadows, a low sun."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from renderer.clouds.bakes import bakes
from renderer.clouds.first_light import bake_bounce_ground, bounce_maps, cells, moment, places, reach
from renderer.clouds.radiosity.bases import GRID
from renderer.clouds.radiosity.maps import BounceMaps
from renderer.clouds.radiosity.technique import solved_of
from renderer.clouds.state import CloudsState
from renderer.core.technique import Arrays, Bake
from renderer.world.sky import sky_for

Maps = Callable[..., BounceMaps]
EVEN: dict[str, Any] = {
    "clouds": {"kind": "uniform"},
    "land": {"kind": "flat"},
    "phase": {"kind": "henyey_greenstein"},
    "scattering": {"kind": "delta_eddington"},
    "bounce": {"kind": "fft"},
}
NEEDED = ("sky", "air", "land", "fields", "phase", "order_fluxes")


def state(**given: Any) -> CloudsState:
    return CloudsState.model_validate({**EVEN, **given})


def arrays(baked: Callable[[Bake], Arrays], document: CloudsState) -> dict[str, Arrays]:
    return {bake.name: baked(bake) for bake in bakes(document) if bake.name in NEEDED}


@pytest.fixture(scope="module")
def mapped(baked: Callable[[Bake], Arrays]) -> Maps:
    def make(**given: Any) -> BounceMaps:
        document = state(**given)
        return bounce_maps(document, arrays(baked, document))

    return make


def sun(elevation: float, azimuth: float = 250.0) -> dict[str, Any]:
    return {"kind": "direction", "azimuth": azimuth, "elevation": elevation}


def test_an_even_layer_lights_level_ground_evenly(mapped: Maps, baked: Callable[[Bake], Arrays]) -> None:
    document = state(sun=sun(30.0), layer={"thickness": 200.0, "extinction": 0.05})
    given = arrays(baked, document)
    light = sky_for(given["sky"], np.radians(30.0))
    model = document.scattering.model(given)  # type: ignore[attr-defined]
    depth, mu = np.array([10.0]), np.array([0.5])
    ground = light.sun_irradiance * model.transmittance(depth, mu)[0] * 0.5
    ground = ground + light.sky_irradiance * (1 - model.diffuse_reflectance(depth)[0])
    found = bounce_maps(document, given)
    np.testing.assert_allclose(found.ground, np.broadcast_to(ground, found.ground.shape), rtol=2e-3)
    np.testing.assert_allclose(found.reflectance[0, 0], model.diffuse_reflectance(depth)[0], rtol=2e-3)
    np.testing.assert_allclose(found.albedo[5, 5], (0.06, 0.085, 0.04), rtol=1e-9)
    assert not found.cloud.any()
    assert (found.n, found.half) == (GRID, 16 * 2500)


def test_no_cloud_leaves_sun_and_sky(mapped: Maps, baked: Callable[[Bake], Arrays]) -> None:
    document = state(sun=sun(30.0), layer={"thickness": 0.0})
    light = sky_for(arrays(baked, document)["sky"], np.radians(30.0))
    found = mapped(sun=sun(30.0), layer={"thickness": 0.0})
    np.testing.assert_allclose(found.ground[0, 0], light.sun_irradiance * 0.5 + light.sky_irradiance, rtol=1e-5)
    assert not found.reflectance.any()


def test_a_sun_under_the_layer_lights_its_base(mapped: Maps) -> None:
    found = mapped(sun=sun(-0.6))
    assert found.cloud.max() > 0.5
    assert found.cloud[0, 0, 0] > 3 * found.cloud[0, 0, 2], "red, after a long way through the air"
    assert not mapped(sun=sun(-5.0)).cloud.any(), "below the horizon of the base, too"


def test_broken_clouds_throw_their_shadows_away_from_the_sun(mapped: Maps) -> None:
    broken = {"kind": "procedural", "cover": 0.5, "cell_size": 9000.0, "systems": False, "evolution": 0.0}
    layer = {"thickness": 150.0, "wind": 0.0}
    high = mapped(clouds=broken, layer=layer, sun=sun(89.0))
    low = mapped(clouds=broken, layer=layer, sun=sun(20.0, azimuth=90.0))
    shift = round(1 / np.tan(np.radians(20.0)) / 0.5)  # cells westwards, of half a height

    def likeness(moved: int) -> float:
        one, other = high.ground[..., 1], np.roll(low.ground[..., 1], moved, axis=1)
        return float(np.corrcoef(one[:, 8:-8].ravel(), other[:, 8:-8].ravel())[0, 1])

    # What is scattered arrives from overhead, so the shadow does not move whole.
    assert likeness(shift) > max(likeness(0), likeness(-shift)) + 0.2
    assert np.corrcoef(high.reflectance[..., 1].ravel(), high.ground[..., 1].ravel())[0, 1] < -0.9


def test_the_layer_drifts_with_the_wind_in_steps(mapped: Maps) -> None:
    broken = {"kind": "procedural", "cover": 0.5, "cell_size": 9000.0, "systems": False, "evolution": 0.0}
    layer = {"wind": 12.5, "wind_azimuth": 90.0}
    assert moment(state(time=12.0, layer=layer)) == 0
    assert moment(state(time=12.6, layer=layer)) == 12.5
    start, later = (mapped(clouds=broken, layer=layer, time=t).reflectance[..., 0] for t in (0.0, 100.0))
    np.testing.assert_allclose(np.roll(start, 1, axis=1)[:, 2:-2], later[:, 2:-2], atol=0.02)
    assert np.abs(start - later).mean() > 0.02


def test_mountains_have_snow_shadows_and_slopes(mapped: Maps) -> None:
    built_in = {"kind": "built_in", "relief": 2.0}
    found = mapped(land=built_in, planet={"snow_line": 600.0}, sun=sun(8.0), layer={"thickness": 0.0})
    inner = slice(26, 38)
    assert found.albedo[inner, inner].max() > 0.7
    assert found.albedo[0, 0] == pytest.approx((0.06, 0.085, 0.04))
    assert found.elevation.max() > 600
    assert found.ground[inner, inner, 0].std() > 10 * found.ground[:8, :8, 0].std()
    low = mapped(land=built_in, layer={"base": 800.0})
    assert low.elevation.max() <= 0.9 * 800


def test_the_ground_of_the_matrices_is_that_of_the_light(baked: Callable[[Bake], Arrays], mapped: Maps) -> None:
    document = state(land={"kind": "built_in"}, planet={"snow_line": 500.0})
    given = {
        "height": 2500.0,
        "albedo": document.planet.albedo,
        "snow_albedo": document.planet.snow_albedo,
        "snow_line": 500.0,
    }
    made = bake_bounce_ground(given, {"land": arrays(baked, document)["land"]}, lambda share, words: None)
    found = mapped(land={"kind": "built_in"}, planet={"snow_line": 500.0})
    np.testing.assert_allclose(made["elevation"], found.elevation)
    assert made["albedo"].shape == (GRID, GRID, 3)


def test_a_far_camera_has_a_wider_square(mapped: Maps, baked: Callable[[Bake], Arrays]) -> None:
    def far(distance: float) -> dict[str, Any]:
        return {"camera": {"kind": "orbit", "target": [0, 0, 2500], "distance": distance}}

    for distance, times in ((20e3, 1), (79e3, 1), (81e3, 2), (161e3, 4), (1e7, 4)):
        assert reach(state(**far(distance))) == times * 2500
    near, wide = mapped(**far(20e3)), mapped(**far(2e5))
    assert (wide.n, wide.half, wide.height) == (GRID, 4 * near.half, near.height)
    np.testing.assert_allclose(wide.ground[32, 32], near.ground[32, 32], rtol=1e-6)
    document = state(**far(2e5))
    assert document.bounce.constants(document, {})["bounce_half"] == 16 * 4 * 2500  # type: ignore[attr-defined]
    even = solved_of(document, arrays(baked, document)).added.ground
    product = wide.albedo * wide.reflectances
    np.testing.assert_allclose(even, wide.ground * product / (1 - product), rtol=1e-3)


def test_cells_are_means() -> None:
    field = np.arange(float((4 * GRID) ** 2)).reshape(4 * GRID, -1)
    assert cells(field)[0, 0] == field[:4, :4].mean()
    along = places(1000.0)
    assert along[0] == pytest.approx(-16_000 + 500 / 8)
    assert along.mean() == pytest.approx(0)


def test_both_slots_read_one_solution(baked: Callable[[Bake], Arrays]) -> None:
    document = state()
    given = arrays(baked, document)
    first = solved_of(document, given)
    assert solved_of(document, given) is first
    assert solved_of(state(sun=sun(26.0)), given) is not first
    assert solved_of(document, {**given, "land": dict(given["land"])}) is not first
    assert document.bounce.frame_textures(document, given)["ground_map"].shape == (GRID, GRID, 3)  # type: ignore[attr-defined]
    even = first.added.ground[GRID // 2, GRID // 2]
    first_light = first.maps.ground[0, 0]
    product = first.maps.albedo[0, 0] * first.maps.reflectances[0, 0]
    np.testing.assert_allclose(even, first_light * product / (1 - product), rtol=1e-3)
