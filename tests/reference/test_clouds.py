"""The clouds' reference against what is known: a plane layer, the clear sky, a furnace, and shadows by hand."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import pytest

from renderer.core.errors import Cancelled, InputError
from renderer.reference import clouds
from renderer.reference.clouds import Options, render
from renderer.reference.clouds_phase import LAST, PEAK_OF, REST_OF, angles, scatter
from renderer.reference.clouds_world import CloudsWorld
from renderer.world import atmosphere
from renderer.world.sun import ANGULAR_RADIUS

HG = 0.85 ** np.arange(120.0)
"""Moments of Henyey and Greenstein's phase function: that of the plane layers in the shared reference values."""

FURNACE = 10.0


def world(**changes: Any) -> CloudsWorld:
    """A bare black planet under an even layer, without air, lit by a sun of unit irradiance."""
    plain = CloudsWorld(
        radius=6.35e6, albedo=(0.0,) * 3, snow_albedo=(1.0,) * 3, snow_line=9000.0, rock_albedo=(0.0,) * 3,
        steepest=math.pi, site_size=1e9, globe=np.zeros((4, 8, 3)), globe_axes=np.eye(3), height=np.zeros((4, 4)),
        land_cell=50.0, base=2000.0, thickness=100.0, extinction=0.08, cloud_map=np.ones((4, 4)), cloud_side=1000.0,
        cloud_repeats=True, cloud_drift=(0.0, 0.0), systems=np.ones((4, 4)), moments=np.stack([HG] * 3),
        sun=sun(0.7), sun_radius=1e-4, sun_irradiance=1.0, haze=1.0, air=False,
    )  # fmt: skip
    return dataclasses.replace(plain, **changes)


def sun(cosine: float) -> tuple[float, float, float]:
    """From the south: light runs to the north."""
    return 0.0, -math.sqrt(1 - cosine * cosine), cosine


def along(directions: np.ndarray, eye: tuple[float, float, float]) -> Any:
    """Parallel to nothing: one ray for each direction (W, 3), all from the eye, whatever the position."""
    origins = np.broadcast_to(np.array(eye), directions.shape)[None].copy()
    return lambda place: (origins, directions[None].copy())


def seen(of: CloudsWorld, directions: Any, eye: tuple[float, float, float], paths: int = 4000) -> tuple[Any, Any]:
    """Radiance and its standard error along some directions."""
    found = render(of, along(np.array(directions, float), eye), np.array([[0.5, 0.5]]), Options(paths=paths))
    return found.radiance[0], found.standard_error[0]


def upward(cosine: float, azimuth: float, side: int = -1) -> list[float]:
    """Direction of a ray that meets light leaving at that cosine, upwards (-1) or downwards (1); azimuth 0 is straight
    on."""
    sine = math.sqrt(1 - cosine * cosine)
    return [-sine * math.sin(azimuth), -sine * math.cos(azimuth), side * cosine]


# L_up and L_down of a_slab.npz (PythonicDISORT; Henyey-Greenstein, conservative, black ground), depth 8, cosine 0.7 of
# the sun, by cosine of the view and azimuth [degrees]; 1/sr for unit irradiance of level ground, so times 0.7 here
SLAB_UP = {(0.25, 0.0): 0.294594, (0.55, 90.0): 0.157477, (0.85, 180.0): 0.117313}
SLAB_DOWN = {(0.25, 0.0): 0.132544, (0.55, 90.0): 0.149626, (0.85, 180.0): 0.151481}


@pytest.mark.parametrize(("depth", "spoiled"), [(8.0, False), (6.5, True)])
def test_a_plane_layer_sends_both_ways_what_discrete_ordinates_say(depth: float, spoiled: bool) -> None:
    layer, scores = world(extinction=depth / 100), []
    for values, eye, side in ((SLAB_UP, (0.0, 0.0, 9000.0), -1), (SLAB_DOWN, (0.0, 0.0, 1500.0), 1)):
        views = [upward(cosine, math.radians(azimuth), side) for cosine, azimuth in values]
        found, error = seen(layer, views, eye)
        scores.append((found[:, :3].mean(axis=1) - 0.7 * np.array(list(values.values()))) / error)
    assert (np.abs(scores).max() < 4) is not spoiled


def test_peak_and_rest_are_the_whole_phase_function() -> None:
    tables, theta = scatter(np.stack([HG, HG, HG])), angles()
    g, cosine = 0.85, np.cos(theta)
    whole = (1 - g * g) / (1 + g * g - 2 * g * cosine) ** 1.5 / (4 * math.pi)
    found = tables.values[PEAK_OF] + tables.values[REST_OF]
    assert len(theta) == LAST + 1
    assert np.abs(found / whole - 1).max() < 3e-3
    assert 0.2 < tables.share[0] < 0.8
    assert tables.values[REST_OF].max() < 0.2 * whole.max()


def test_a_furnace_is_as_bright_everywhere() -> None:
    white = world(albedo=(1.0,) * 3, sun_irradiance=0.0, space=FURNACE, thickness=60.0)
    found, _ = seen(white, [upward(0.9, 0.0), upward(0.2, 1.0), upward(0.5, 2.0, 1)], (0.0, 0.0, 9000.0), 400)
    # the longest paths end by chance, and what goes on counts for more
    assert found[:, :3] == pytest.approx(FURNACE, rel=0.02)
    grey, _ = seen(dataclasses.replace(white, albedo=(0.5,) * 3), [upward(0.9, 0.0)], (0.0, 0.0, 9000.0), 400)
    assert 0.5 * FURNACE < grey[0, 0] < 0.99 * FURNACE


def test_a_clear_sky_is_that_of_the_air() -> None:
    """Of blue light a fifth is scattered twice or more, which the closed form of the shared sky knows to a tenth."""
    air = world(air=True, albedo=(0.15,) * 3, extinction=0.0, thickness=0.0, sun=sun(0.5), sun_radius=ANGULAR_RADIUS)
    directions = [[0.0, 0.8, 0.6], [0.6, 0.0, 0.8], [-0.95, 0.0, math.sqrt(1 - 0.95**2)]]
    found, error = seen(air, directions, (0.0, 0.0, 1.0), 3000)
    expected = clear_sky(np.array(directions), np.array(air.sun))
    assert np.all(error < 0.03 * expected.mean(axis=1))
    assert found[:, :3] == pytest.approx(expected, rel=0.1)


def clear_sky(directions: np.ndarray, to_sun: np.ndarray) -> np.ndarray:
    """Radiance of the shared sky's model for unit irradiance, integrated here."""
    air = atmosphere.breathe(atmosphere.Atmosphere(), ANGULAR_RADIUS)
    found = np.zeros((len(directions), 3))
    for number, d in enumerate(directions):
        end = float(atmosphere.to_top(np.array(atmosphere.GROUND + 1e-3), np.array(d[2])))
        edges = end * np.linspace(0, 1, 400) ** 2
        t, step = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)
        places = np.array([0, 0, atmosphere.GROUND + 1e-3]) + t[:, None] * d
        r = np.linalg.norm(places, axis=1)
        rayleigh, mie, lost = atmosphere.coefficients(r - atmosphere.GROUND, 1.0)
        through = np.exp(-np.cumsum(lost * step[:, None], axis=0) + 0.5 * lost * step[:, None])
        mu, facing = places @ to_sun / r, float(d @ to_sun)
        beam = atmosphere.transmittance(air, r, mu)
        phase = 3 / (16 * math.pi) * (1 + facing**2), 3 / (8 * math.pi) * 0.36 / 2.64 * (1 + facing**2) / (
            1.64 - 1.6 * facing
        ) ** 1.5
        source = beam * (rayleigh * phase[0] + mie * phase[1]) + atmosphere.glow(air, r, mu) * (rayleigh + mie)
        found[number] = (through * source * step[:, None]).sum(axis=0)
    return found


def test_a_hill_hides_the_sun_from_the_ground_behind_it() -> None:
    hill = np.zeros((64, 64))
    hill[20:24] = 400.0
    bare = world(extinction=0.0, thickness=0.0, albedo=(0.5,) * 3, height=hill, sun=sun(0.4))
    lit = 0.5 / math.pi * 0.4
    # rows go north: the shadow of the hill at -525 m falls to the north, over 400 m cot(elevation) = 917 m
    found, _ = seen(bare, [[0.0, 0.0, -1.0]], (0.0, 0.0, 3000.0), 50)
    beyond, _ = seen(bare, [[0.0, 0.0, -1.0]], (0.0, 1200.0, 3000.0), 50)
    assert found[0, 0] < 0.05 * lit  # what other slopes throw back
    assert beyond[0, 0] == pytest.approx(lit, rel=2e-3)


def test_what_cannot_be_traced_is_refused_in_words() -> None:
    rays = along(np.array([[0.0, 0.0, -1.0]]), (0.0, 0.0, 3000.0))
    with pytest.raises(InputError):
        render(world(), rays, np.zeros((0, 2)))
    with pytest.raises(InputError):
        render(world(), rays, np.array([[0.5, 0.5]]), Options(paths=1))
    with pytest.raises(InputError):
        render(world(sun=(0.0, 0.0, 2.0)), rays, np.array([[0.5, 0.5]]))


def test_the_caller_may_stop_it(monkeypatch: pytest.MonkeyPatch) -> None:
    def stop(share: float, words: str) -> None:
        raise Cancelled("enough")

    monkeypatch.setattr(clouds, "CHUNK", 1)
    with pytest.raises(Cancelled):
        render(world(), along(np.array([[0.0, 0.0, -1.0]]), (0, 0, 3000.0)), np.array([[0.5, 0.5]]), Options(8), stop)
