"""The forest reference against closed forms in degenerate worlds, and against itself when it is refined.

Each closed form is also asked of a spoiled world (the sun mirrored, a factor pi), which it must reject.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from renderer.core.errors import Cancelled, InputError
from renderer.reference.forest import Options, render
from renderer.reference.forest_world import ForestWorld
from tests.reference.worlds import CENTRE, E_SUN, GROUND, UP, flat, grove, looking, sun, unit

EXACT = Options(shadow_rays=0)
ALPHA = 20
SIGMA = -np.log(1 - ALPHA / 255) / 0.625
STORED_UP = unit(UP / 255 * 2 - 1)


def slab(view: np.ndarray, to_sun: np.ndarray, albedo: float = 0.5) -> np.ndarray:
    """Radiance of a uniform layer on Lambertian ground: single scattering (Chandrasekhar 1950)."""
    mu, nu, depth = -view[2], to_sun[2], SIGMA * 20
    both = depth * (1 / mu + 1 / nu)
    leaf = albedo / np.pi * max(STORED_UP @ to_sun, 0) / (1 + mu / nu) * (1 - np.exp(-both))
    return np.array(E_SUN) * (leaf + np.array(GROUND) / np.pi * nu * np.exp(-both))


@pytest.mark.parametrize("view", [(0, 0, -1), (0.3, 0.5, -0.4), (-0.9, 0.1, -0.2)])
@pytest.mark.parametrize("to_sun", [(0.0, 0.0, 1.0), (0.6, 0.0, 0.8), (-0.3, 0.8, 0.3)])
def test_uniform_slab_obeys_beer_and_lambert_along_both_rays(view: tuple, to_sun: tuple) -> None:
    s = tuple(float(c) for c in unit(to_sun))
    found = render(flat(ALPHA, sun=s), looking([[1, 2], [30, -20]], view), CENTRE, EXACT)
    expected = slab(unit(view), np.array(s))
    # spent by the midpoint rule: (sigma step (1 + mu / nu))^2 / 24 at most, with steps of 0.3 voxels: 4e-5;
    # by the march's end at a ten-thousandth of the light: 1e-4 of the radiance's change behind it
    assert found.radiance[0, :, :3] == pytest.approx(np.tile(expected, (2, 1)), rel=1.5e-4)
    assert found.radiance[0, :, 3] == pytest.approx(1)
    for spoiled in (
        flat(ALPHA, sun=s, e_sun=tuple(np.array(E_SUN) * np.pi)),
        flat(ALPHA, sun=tuple(unit((s[1], s[2], s[0] + 0.1)))),
    ):
        wrong = render(spoiled, looking([[1, 2]], view), CENTRE, EXACT).radiance[0, 0, :3]
        assert wrong != pytest.approx(expected, rel=1e-2)


def test_sheared_layer_on_a_slope_keeps_its_vertical_thickness() -> None:
    nodes = 65
    tilted = np.repeat((np.arange(nodes) * 8.0 * 0.5)[None], nodes, axis=0)
    world = flat(ALPHA, nodes=nodes, elevation=tilted)
    # straight down and a zenith sun see exactly the layer's height, whatever the slope
    found = render(world, lambda _: (np.array([[[3.0, 5.0, 500.0]]]), np.array([[[0.0, 0.0, -1.0]]])), CENTRE, EXACT)
    leaf = 0.5 / np.pi * STORED_UP[2] / 2 * (1 - np.exp(-2 * SIGMA * 20))
    ground = np.array(GROUND) / np.pi / np.sqrt(1.25) * np.exp(-2 * SIGMA * 20)
    assert found.radiance[0, 0, :3] == pytest.approx(np.array(E_SUN) * (leaf + ground), rel=1e-5)


def test_bare_ground_is_lambertian_in_sun_and_sky() -> None:
    world = flat(0, e_sky=(1.0, 1.5, 2.0), sun=sun(200, 40))
    found = render(world, looking([[0, 0]], (0.2, 0.3, -0.5)), CENTRE)
    in_the_wood = np.array(GROUND) / np.pi * (np.array(E_SUN) * np.sin(np.radians(40)))
    assert found.radiance[0, 0, :3] == pytest.approx(in_the_wood), "ambient of the lowest voxels is 0 here"
    found = render(replace(world, cover=np.zeros_like(world.cover)), looking([[0, 0]]), CENTRE)
    assert found.radiance[0, 0, :3] == pytest.approx(in_the_wood + np.array(GROUND) / np.pi * (1.0, 1.5, 2.0))


def test_tilted_ground_takes_the_cosine_to_its_own_normal_and_its_share_of_the_sky() -> None:
    nodes = 33
    tilted = np.repeat((np.arange(nodes) * 8.0 * 0.75)[:, None], nodes, axis=1)  # rises to the south, faces north
    world = flat(0, elevation=tilted, cover=np.zeros((nodes, nodes)), e_sky=(1.0, 1.0, 1.0), sun=sun(0, 30))
    found = render(world, lambda _: (np.array([[[3.0, 5.0, 500.0]]]), np.array([[[0.0, 0.0, -1.0]]])), CENTRE)
    normal = np.array([0, 0.6, 0.8])
    light = np.array(E_SUN) * (normal @ world.sun) + (1 + 0.8) / 2
    assert found.radiance[0, 0, :3] == pytest.approx(np.array(GROUND) / np.pi * light)
    away = render(replace(world, sun=sun(180, 30)), looking([[3, 5]]), CENTRE).radiance[0, 0, :3]
    assert away == pytest.approx(np.array(GROUND) / np.pi * 0.9), "the sun behind the slope gives nothing"


def lit_ground(world: ForestWorld, points: list[list[float]]) -> np.ndarray:
    """Whether level ground is in the sun at each point, seen from straight above."""
    shade = render(world, looking(points), CENTRE).radiance[0, :, 0]
    return shade / (GROUND[0] / np.pi * E_SUN[0] * world.sun[2])


def test_terrain_wall_casts_its_shadow_where_geometry_says() -> None:
    nodes = 65
    cliff = np.zeros((nodes, nodes))
    cliff[:, : nodes // 2] = 30.0  # the last high node stands at x = -8, the ground reaches level at x = 0
    world = flat(0, nodes=nodes, elevation=cliff, sun=sun(270, 25))
    edge = -8 + 30 / np.tan(np.radians(25))
    assert lit_ground(world, [[edge - 0.02, 3], [edge + 0.02, 3], [10, -20]]) == pytest.approx([0, 1, 0], abs=1e-9)
    mirrored = replace(world, sun=sun(90, 25))
    assert lit_ground(mirrored, [[edge - 0.02, 3]]) == pytest.approx([1]), "a sun of the wrong sign lights the shadow"
    assert render(world, looking([[10, -20]]), CENTRE, Options(terrain=False)).radiance[0, 0, 0] > 0


def test_opaque_wall_of_voxels_casts_its_shadow_where_geometry_says() -> None:
    # texels 8..11 of every row along the second edge direction: endless walls at 60 degrees to the east, 16 layers high
    alpha = np.zeros((32, 64, 64), np.uint8)
    alpha[:16, :, [16 * p + i for p in range(4) for i in range(8, 12)]] = 255
    across = np.array([np.sqrt(0.75), -0.5])
    to_sun = unit([*(across * np.cos(np.radians(50))), np.sin(np.radians(50))])
    world = flat(alpha, sun=tuple(float(c) for c in to_sun))
    texel = 40 / 16
    start = across * (8 * texel * np.sqrt(0.75))  # the wall's side away from the sun, at a place on it

    def reach(height: float) -> float:
        return height / np.tan(np.radians(50))

    # full opacity ends at the centre of layer 15, the filter's last reach at the centre of layer 16
    inside, outside = reach(15.5 * 0.625) - texel, reach(16.5 * 0.625) + texel
    points = [start - across * distance for distance in (2.0, inside, outside, outside + 5)]
    assert lit_ground(world, np.array(points).tolist()) == pytest.approx([0, 0, 1, 1], abs=1e-6)
    sunny = render(world, looking(points[1]), CENTRE, Options(forest_on_ground=False)).radiance[0, 0, 0]
    assert sunny == pytest.approx(GROUND[0] / np.pi * E_SUN[0] * to_sun[2])


def test_a_furnace_is_even() -> None:
    world = flat(60, ambient=255, albedo=1.0, e_sun=(0, 0, 0), e_sky=(1.0, 2.0, 3.0), ground_albedo=(1.0, 1.0, 1.0))
    found = render(world, looking([[3, 1]], (0.5, 0, -0.4)), CENTRE)
    # The stored normal leans by half a byte.
    assert found.radiance[0, 0, :3] == pytest.approx(np.array([1.0, 2.0, 3.0]) / np.pi, rel=2e-5)


def test_no_pixel_of_a_grove_is_brighter_than_its_matter_can_be() -> None:
    found = render(grove(), looking(np.random.default_rng(2).uniform(-100, 100, (200, 2))), CENTRE)
    brightest = 0.5 * 1.2 * (np.array(E_SUN) + (0.5, 0.6, 0.8)) / np.pi
    assert (found.radiance[..., :3] <= brightest).all()
    assert (found.radiance[..., :3] > 0).all()


def test_trees_stand_only_where_the_cover_says() -> None:
    cover = np.ones((33, 33))
    cover[:, :16] = 0.0  # 0.5 at x = -4
    world = flat(200, cover=cover, ground_albedo=(0.0, 0.0, 0.0))
    found = render(world, looking([[-4.2, 0], [-3.8, 0], [-60, 9]]), CENTRE).radiance[0, :, 0]
    assert found[0] == found[2] == 0
    assert found[1] > 0


def test_alpha_and_background_over_the_edge_of_the_world() -> None:
    world = flat(ALPHA, cover=np.ones((33, 33)))
    level = lambda _: (np.array([[[-100.0, 0.0, 30.0]]]), np.array([[[1.0, 0.0, 0.0]]]))  # noqa: E731
    assert render(world, level, CENTRE).radiance[0, 0].tolist() == [0, 0, 0, 0], "above the canopy there is nothing"
    sky = replace(world, background=lambda d: np.abs(d) + 1)
    assert render(sky, level, CENTRE).radiance[0, 0].tolist() == [2, 1, 1, 0]
    # a rising ray from inside the layer crosses 10 m of it, vertically
    rising = unit([0.8, 0, 0.6])
    inside = lambda _: (np.array([[[0.0, 0.0, 10.0]]]), rising[None, None])  # noqa: E731
    assert render(world, inside, CENTRE).radiance[0, 0, 3] == pytest.approx(1 - np.exp(-SIGMA * 10 / 0.6))


def test_pixels_are_the_mean_of_their_positions() -> None:
    world = grove()

    def rays(offset: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
        x = (np.arange(20) + offset[0]) * 4 - 40
        origins = np.stack([x, np.full(20, offset[1] * 4), np.full(20, 50.0)], axis=1)[None]
        return origins, np.broadcast_to([0.0, 0.0, -1.0], origins.shape)

    positions = np.array([[0.1, 0.2], [0.7, 0.9]])
    both = render(world, rays, positions, EXACT).radiance
    apart = [render(world, rays, positions[k : k + 1], EXACT).radiance for k in (0, 1)]
    assert both == pytest.approx(0.5 * (apart[0] + apart[1]))


def test_gouraud_takes_the_grounds_normal() -> None:
    world = flat(ALPHA, sun=sun(100, 40))
    sideways = np.array(world.normal)
    sideways[..., :3] = (255, 128, 128)
    world = replace(world, normal=sideways)
    lambert = render(world, looking([[0, 0]]), CENTRE, EXACT).radiance[0, 0, 0]
    gouraud = render(world, looking([[0, 0]]), CENTRE, replace(EXACT, light="gouraud")).radiance[0, 0, 0]
    ground = GROUND[0] / np.pi * E_SUN[0] * world.sun[2] * np.exp(-SIGMA * 20 * (1 + 1 / world.sun[2]))
    facing = unit(np.array([255, 128, 128]) / 255 * 2 - 1) @ world.sun
    assert (lambert - ground) / (gouraud - ground) == pytest.approx(facing / world.sun[2], rel=1e-6)


def test_progress_rises_and_can_stop_the_work() -> None:
    shares: list[float] = []
    render(flat(0), looking([[0, 0]]), np.tile(CENTRE, (3, 1)), progress=lambda share, words: shares.append(share))
    assert shares == pytest.approx([1 / 3, 2 / 3, 1])

    def stop(share: float, words: str) -> None:
        raise Cancelled("enough")

    with pytest.raises(Cancelled):
        render(flat(0), looking([[0, 0]]), CENTRE, progress=stop)


def test_worlds_that_do_not_fit_together_are_refused() -> None:
    for change in (
        {"cover": np.zeros((3, 3))},
        {"tile": np.full((2, 2, 8, 2), 9, np.uint8)},
        {"sun": (0.0, 0.0, 2.0)},
        {"cell": 0.0},
    ):
        with pytest.raises(InputError, match=next(iter(change))):
            flat(0, **change)
    with pytest.raises(InputError, match="positions"):
        render(flat(0), looking([[0, 0]]), np.zeros((0, 2)))
