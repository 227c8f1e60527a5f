"""Rays against triangles: closed forms, and the volume reference of the same block."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from renderer.core.errors import InputError
from renderer.reference import forest
from renderer.reference.forest_mesh import MeshWorld, render
from tests.reference.worlds import CENTRE, E_SUN, GROUND, flat, looking, sun, unit

SKY = (1.0, 2.0, 3.0)


def plate(half: float, height: float, to_sun: tuple[float, float, float], **changes: object) -> MeshWorld:
    """A level square plate above the origin."""
    vertices = np.array([[-half, -half, height], [half, -half, height], [half, half, height], [-half, half, height]])
    given = {"vertices": vertices, "faces": np.array([[0, 1, 2], [0, 2, 3]]), "albedo": np.full((2, 3), 0.5),
             "ground_albedo": GROUND, "e_sun": E_SUN, "e_sky": (0.0, 0.0, 0.0), "sun": to_sun}
    given.update(changes)
    return MeshWorld(**given)  # type: ignore[arg-type]


def test_the_plates_shadow_lies_where_geometry_says() -> None:
    world = plate(3, 10, sun(90, 50))
    east = 3 - 10 / np.tan(np.radians(50))  # the sun stands in the east, so the shadow of the 6 m plate falls west
    full = GROUND[0] / np.pi * E_SUN[0] * np.sin(np.radians(50))
    points = [[east + 0.01, 0], [east - 0.01, 0], [east - 5.99, 2.99], [east - 6.01, 0], [east - 3, 3.01]]
    # seen from far below the plate's own level, so that it hides none of them
    found = render(world, looking(points, (0, 0.99, -0.1)), CENTRE).radiance[0, :, 0]
    assert found == pytest.approx([full, 0, 0, full, full])
    mirrored = plate(3, 10, sun(270, 50))
    assert render(mirrored, looking([[east - 5.99, 0]]), CENTRE).radiance[0, 0, 0] == pytest.approx(full)


def test_both_sides_are_lambertian() -> None:
    world = plate(3, 10, sun(0, 90))
    above = render(world, looking([[0, 0]]), CENTRE).radiance[0, 0]
    assert above[:3] == pytest.approx(0.5 / np.pi * np.array(E_SUN))
    assert above[3] == 1
    upwards = lambda _: (np.array([[[0.0, 0.0, 1.0]]]), np.array([[[0.0, 0.0, 1.0]]]))  # noqa: E731
    below = render(world, upwards, CENTRE).radiance[0, 0].tolist()
    assert below == [0, 0, 0, 1], "its underside faces away from the sun"


def test_the_sky_is_blocked_by_solid_angle() -> None:
    world = plate(4, 3, sun(0, 90), e_sun=(0.0, 0.0, 0.0), e_sky=SKY)
    below = lambda _: (np.array([[[0.0, 0.0, 1.0]]]), np.array([[[0.0, 0.0, -1.0]]]))  # noqa: E731
    found = render(world, below, np.tile(CENTRE, (400, 1)), sky_rays=64)
    # solid angle of a square of half side a at distance d, seen on its axis: 4 asin(a^2 / (a^2 + d^2))
    share = 1 - 4 * np.arcsin(16 / (16 + 9)) / (2 * np.pi)
    expected = np.array(GROUND) / np.pi * SKY * share
    error = float(found.standard_error[0, 0])
    assert error < 0.01 * expected.mean()
    assert found.radiance[0, 0, :3].mean() == pytest.approx(expected.mean(), abs=4 * error)
    # a cosine-weighted sky (1 - form factor of the plate) is far from it: the test can tell the two apart
    rng = np.random.default_rng(1)
    xy = rng.uniform(-4, 4, (200_000, 2))
    form = float(np.mean(9 / (np.pi * (9 + (xy**2).sum(axis=1)) ** 2))) * 64
    assert abs((1 - form) / share - 1) > 0.1


def test_opaque_block_agrees_with_the_volume_reference() -> None:
    # endless black walls of one atlas, four texels wide and 16 layers high, against the same walls as boxes
    alpha = np.zeros((32, 64, 64), np.uint8)
    columns = [16 * p + i for p in range(4) for i in range(8, 12)]
    alpha[:16, :, columns] = 255
    texel, along = 40 / 16, np.array([0.5, np.sqrt(0.75)])
    vertices, faces = [], []
    for n in range(-4, 5):
        low, high = np.array([n * 40 + 8 * texel, 0]), np.array([n * 40 + 12 * texel, 0])
        corners = [low - 500 * along, high - 500 * along, high + 500 * along, low + 500 * along]
        first = len(vertices)
        vertices += [[*c, z] for z in (0.0, 10.0) for c in corners]
        quads = [(4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
        faces += [[first + a, first + b, first + c] for q in quads for a, b, c in (q[:3], (q[0], q[2], q[3]))]
    to_sun = sun(120, 40)
    volume = flat(alpha, albedo=0.0, sun=to_sun)
    black = np.zeros((len(faces), 3))
    mesh = MeshWorld(np.array(vertices), np.array(faces), black, GROUND, E_SUN, (0, 0, 0), to_sun)
    points = looking(np.random.default_rng(1).uniform(-40, 40, (800, 2)))
    solid = render(mesh, points, CENTRE).radiance[0, :, 0]
    fog = forest.render(volume, points, CENTRE).radiance[0, :, 0]
    lit = GROUND[0] / np.pi * E_SUN[0] * to_sun[2]
    differs = np.abs(fog - solid) > 0.1 * lit
    # only within the filter's width of the wall's two edges and its shadow's one, in a period of 34.6 m across
    assert differs.mean() < 3 * 0.5 * texel / 34.6
    # the sun stands straight across the walls: their width and their shadow's length, 4 sd of 800 points
    dark = (4 * texel * np.sqrt(0.75) + 10 / np.tan(np.radians(40))) / (40 * np.sqrt(0.75))
    assert float((solid < 0.01).mean()) == pytest.approx(dark, abs=0.07)
    taller = render(replace(mesh, vertices=mesh.vertices * (1, 1, 1.5)), points, CENTRE).radiance[0, :, 0]
    assert (np.abs(fog - taller) > 0.1 * lit).mean() > 2 * differs.mean()


def test_background_and_empty_sky() -> None:
    level = lambda _: (np.array([[[-9.0, 0.0, 30.0]]]), unit([1, 0, 0])[None, None])  # noqa: E731
    assert render(plate(3, 10, sun(0, 90)), level, CENTRE).radiance[0, 0].tolist() == [0, 0, 0, 0]
    blue = plate(3, 10, sun(0, 90), background=lambda d: np.tile([0.1, 0.2, 0.3], (len(d), 1)))
    assert render(blue, level, CENTRE).radiance[0, 0].tolist() == [0.1, 0.2, 0.3, 0]


def test_what_is_no_mesh_is_refused() -> None:
    with pytest.raises(InputError, match="faces"):
        plate(1, 1, sun(0, 90), faces=np.array([[0, 1, 9]]))
    with pytest.raises(InputError, match="faces"):
        plate(1, 1, sun(0, 90), faces=np.zeros((0, 3), int))
    with pytest.raises(InputError, match="albedo"):
        plate(1, 1, sun(0, 90), albedo=np.zeros((1, 3)))
    with pytest.raises(InputError, match="positions"):
        render(plate(1, 1, sun(0, 90)), looking([[0, 0]]), np.zeros((0, 2)))
