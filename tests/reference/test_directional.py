"""The directional textures' truth: closed forms, shadow by shadow and light by light."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from renderer.core.errors import InputError
from renderer.reference.directional import Options, render
from renderer.reference.directional_light import phong
from renderer.reference.directional_mesh import Hits
from renderer.reference.directional_world import DirectionalWorld, Lamp, Measured, Phong, Surroundings, part_of
from tests.reference.directional import CENTRE, E_SUN, ball, beams, quads, seen, square, unit

MATT = ((1.0, Phong(0.0, 1.0, 0.0, 1.0)),)
SKYLIT = ((1.0, Phong(1.0, 0.0, 0.0, 1.0)),)
SUN = tuple(unit([0.6, 0.0, 0.8]))


def across_a_ball(count: int = 300) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Origins and directions of rays that meet the unit ball, and where they do."""
    rng = np.random.default_rng(3)
    places = unit(rng.normal(size=(count, 3)))
    origins = 5 * unit(places + 0.5 * unit(rng.normal(size=(count, 3))))
    return origins, unit(places - origins), places


def test_a_ball_in_the_sun_follows_lamberts_cosine() -> None:
    """Its facets lie 1e-4 below the ball, so a ray meets them that far off, and their own horizon is a degree
    early."""
    origins, directions, places = across_a_ball()
    found = seen(ball(parts=MATT, sun=SUN, e_sun=E_SUN), beams(origins, directions))
    cosine = places @ SUN
    right = 0.5 / np.pi * np.maximum(cosine, 0)[:, None] * E_SUN
    clear = np.abs(cosine) > 0.05
    assert found[clear, :3] == pytest.approx(right[clear], abs=2e-3 * right.max())
    assert (found[:, 3] == 1).all()
    other = 0.5 / np.pi * np.maximum(places @ np.multiply(SUN, [-1, 1, 1]), 0)[:, None] * E_SUN
    assert np.abs(found[clear, :3] - other[clear]).max() > 0.5 * right.max(), "another sun is told apart"


def bands(height: int = 256) -> np.ndarray:
    """Radiance 2 + x - y/2 + z/4 of the direction (x, y, z), as a picture."""
    polar, azimuth = np.meshgrid((np.arange(height) + 0.5) / height * np.pi,
                                 (np.arange(2 * height) + 0.5) / height * np.pi, indexing="ij")  # fmt: skip
    x, y, z = np.sin(polar) * np.sin(azimuth), np.sin(polar) * np.cos(azimuth), np.cos(polar)
    return np.repeat((2 + x - y / 2 + z / 4)[..., None], 3, axis=2)


def test_a_mirroring_ball_shows_its_surroundings() -> None:
    origins, directions, places = across_a_ball()
    world = ball(parts=((1.0, Surroundings(bands(), 0.0, 0.0, 1.0)),))
    mirrored = directions - 2 * np.sum(directions * places, axis=1, keepdims=True) * places
    clear = np.sum(mirrored * places, axis=1) > 0.1
    assert seen(world, beams(origins, directions))[clear, 0] == pytest.approx(
        (2 + mirrored @ [1, -0.5, 0.25])[clear], abs=3e-3
    )
    # turned clockwise by a quarter, what stood in the north stands in the east
    turned = dataclasses.replace(world, parts=((1.0, Surroundings(bands(), np.pi / 2, 0.0, 1.0)),))
    assert seen(turned, beams(origins, directions))[clear, 0] == pytest.approx(
        (2 + mirrored @ [-0.5, -1, 0.25])[clear], abs=3e-3
    )


def test_surroundings_are_gathered_by_the_cosine() -> None:
    """Of a radiance 2 + a.d a plane gathers 2 pi + 2 pi / 3 a.n."""
    origins, directions, places = across_a_ball()
    found = seen(ball(parts=((1.0, Surroundings(bands(), 0.0, 1.0, 0.0)),)), beams(origins, directions))
    right = 0.5 / np.pi * (2 * np.pi + 2 * np.pi / 3 * places @ [1, -0.5, 0.25])
    assert found[:, 0] == pytest.approx(right, rel=1e-3)


def test_a_white_ball_vanishes_in_white_surroundings() -> None:
    """The white furnace; nothing convex is shadowed by itself."""
    origins, directions, _ = across_a_ball()
    world = ball(1.0, parts=((1.0, Surroundings(np.full((16, 32, 3), 3.0), 0.4, 1.0, 0.0)),))
    found = seen(world, beams(origins, directions), strata=6)
    assert np.median(found[:, 0]) == pytest.approx(3.0, rel=3e-4)
    assert found[:, :3] == pytest.approx(np.full((300, 3), 3.0), rel=0.03), "but where smooth normals see own facets"


@pytest.mark.parametrize("exponent", [1.0, 10.0, 100.0])
def test_phongs_lobe_reflects_all_and_never_more(exponent: float) -> None:
    part, count = Phong(0.0, 0.0, 1.0, exponent), 400
    z, turn = 1 - ((np.arange(count) + 0.5) / count) ** 2, 2 * np.pi * (np.arange(count) + 0.5) / count
    up, around = (each.ravel() for each in np.meshgrid(z, turn))
    light = np.stack([np.sqrt(1 - up**2) * np.cos(around), np.sqrt(1 - up**2) * np.sin(around), up], axis=1)
    flat = np.zeros_like(light)
    for tilt, least, most in ((0.0, 0.999, 1.001), (0.7, 0.3, 1.0), (1.4, 0.0, 1.0)):
        eye = np.broadcast_to([np.sin(tilt), 0, np.cos(tilt)], light.shape)
        hits = Hits(flat, flat, np.broadcast_to([0.0, 0.0, 1.0], light.shape), flat, eye)
        # a step of z is 2 sqrt(1 - z) of the even ones: fine about the zenith, where a narrow lobe stands
        sent = (phong(part, hits, light)[:, 0] * 2 * np.sqrt(1 - up)).mean()
        assert least <= 2 * np.pi * sent <= most


GROUND, PLATE = square(20, 0), square(2, 5)


def lit_points(world: DirectionalWorld, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Whether points of the ground under the plate have light, seen aslant past it."""
    towards = unit([0.0, 5.0, -1.0])
    points = np.stack([x, y, np.zeros_like(x)], axis=-1)
    return seen(world, beams(points - 0.5 * towards, towards))[:, 0] > 0


def test_a_squares_shadow_is_its_projection() -> None:
    rng = np.random.default_rng(7)
    x, y = rng.uniform(-10, 10, (2, 4000))
    sun = lit_points(quads([GROUND, PLATE], parts=MATT, sun=SUN, e_sun=E_SUN), x, y)
    # the sun stands in the east: the shadow falls 5 * 0.6 / 0.8 westwards
    inside = (np.abs(x + 3.75) < 2) & (np.abs(y) < 2)
    assert (sun != inside).all()
    lamp = Lamp((1.0, 0.0, 10.0), (100.0, 100.0, 100.0))
    # from twice the plate's height it doubles, about the lamp's foot
    found = lit_points(quads([GROUND, PLATE], parts=MATT, lamp=lamp), x, y)
    assert (found != ((np.abs(x + 1) < 4) & (np.abs(y) < 4))).all()
    bare = lit_points(quads([GROUND, PLATE], parts=MATT, sun=SUN, e_sun=E_SUN, shadows=False), x, y)
    assert bare.all()


def test_what_stands_behind_a_lamp_throws_no_shadow() -> None:
    lamp = Lamp((0.0, 0.0, 3.0), (9.0, 18.0, 27.0))
    found = seen(quads([GROUND, PLATE], parts=MATT, lamp=lamp), beams([0, 0, 1], [0, 0, -1]))
    assert found[0, :3] == pytest.approx(0.5 / np.pi * np.array([1.0, 2.0, 3.0]), rel=1e-4)


def test_openness_of_a_plain_and_at_the_foot_of_a_wall() -> None:
    """Before an endless wall of height h at distance d the plain keeps (1 + d / sqrt(d^2 + h^2)) / 2."""
    far, e_sky = 100.0, (np.pi, np.pi, np.pi)
    wall = [[0, -far, 0], [0, far, 0], [0, far, 3], [0, -far, 3]]
    plain = [[-far, -far, 0], [far, -far, 0], [far, far, 0], [-far, far, 0]]
    assert seen(quads([plain], 1.0, parts=SKYLIT, e_sky=e_sky), beams([1, 1, 1], [0, 0, -1]), 4)[0, 0] == 1.0
    distance = np.array([0.3, 1.0, 4.0, 12.0])
    looking = beams(np.stack([distance, 0 * distance, 0 * distance + 1], axis=1), [0, 0, -1])
    found = render(quads([plain, wall], 1.0, parts=SKYLIT, e_sky=e_sky), looking, np.tile(CENTRE, (40, 1)), Options(16))
    right = (1 + distance / np.hypot(distance, 3)) / 2
    error = found.standard_error[0]
    assert (error > 0).all()
    assert (error < 3e-3).all()
    # rays begin 3 mm above the plain: 5e-3 of the wall's share at 0.3 m
    assert (np.abs(found.radiance[0, :, 0] - right) < 4 * error + 2e-3).all()
    assert np.abs(found.radiance[0, :, 0] - 1 / (1 + 3 / distance)).max() > 0.1


def test_the_standard_error_is_what_seeds_differ_by() -> None:
    wall = [[0, -40, 0], [0, 40, 0], [0, 40, 3], [0, -40, 3]]
    world = quads([square(40, 0), wall], 1.0, parts=SKYLIT, e_sky=(np.pi, np.pi, np.pi))
    looking = beams([[1.5, y, 2.0] for y in np.linspace(-9, 9, 400)], [0, 0, -1])
    found = render(world, looking, CENTRE, Options(4))
    said = float(np.sqrt(np.mean(found.standard_error**2)))
    drawn = float(found.radiance[0, :, 0].std())
    assert drawn <= said < 2.5 * drawn


def test_a_face_from_behind_turns_its_normal_only_where_it_has_two_sides() -> None:
    below = quads([square(1, 0)], parts=MATT, sun=(0.0, 0.0, -1.0), e_sun=E_SUN)
    looking = beams([0, 0, -3], [0.1, 0.1, 1])
    assert seen(below, looking)[0].tolist() == [0, 0, 0, 1]
    turned = dataclasses.replace(below, two_sided=True)
    assert seen(turned, looking)[0, :3] == pytest.approx(0.5 / np.pi * np.array(E_SUN))
    above = dataclasses.replace(below, sun=(0.0, 0.0, 1.0))
    assert seen(above, looking)[0, :3] == pytest.approx(0.5 / np.pi * np.array(E_SUN)), "the one normal counts"


def test_parts_add_up_by_their_weights_and_materials_stand_in_the_suns_irradiance() -> None:
    polar, one_node = np.array([0.0, np.pi / 2]), np.zeros(1)
    even = Measured("difference", (polar, one_node, polar, one_node), np.full((2, 1, 2, 1, 3), 0.2), 0.5)
    looking, light = beams([0, 0, 3], [0.2, 0.1, -1]), {"sun": SUN, "e_sun": E_SUN, "e_sky": (1.0, 2.0, 3.0)}
    one = seen(quads([square(1, 0)], parts=((1.0, even),), **light), looking)[0, :3]
    assert one == pytest.approx(0.2 * 0.8 * np.array(E_SUN) + 0.5 * 0.5 / np.pi * np.array([1.0, 2.0, 3.0]))
    two = seen(quads([square(1, 0)], parts=((0.25, even), (2.0, MATT[0][1])), **light), looking)[0, :3]
    assert two == pytest.approx(0.25 * one + 2 * 0.5 / np.pi * 0.8 * np.array(E_SUN))


def test_parts_are_made_of_plain_values() -> None:
    phong = {"kind": "phong", "ambient": 0.1, "diffuse": 0.2, "specular": 0.3, "exponent": 4.0}
    assert part_of({**phong, "weight": 0.5}) == (0.5, Phong(0.1, 0.2, 0.3, 4.0))
    assert part_of(phong) == (1.0, Phong(0.1, 0.2, 0.3, 4.0))
    image, nodes = np.zeros((2, 4, 3)), (np.zeros(1),) * 4
    assert part_of({"kind": "surroundings", "image": image, "rotation": 1.0, "diffuse": 0.4, "specular": 0.6}) == (
        1.0, Surroundings(image, 1.0, 0.4, 0.6)
    )  # fmt: skip
    values = np.zeros((1, 1, 1, 1, 3))
    assert part_of({"kind": "measured", "coordinates": "half", "nodes": nodes, "values": values, "ambient": 0.2}) == (
        1.0, Measured("half", nodes, values, 0.2)
    )  # fmt: skip
    with pytest.raises(InputError, match="kind"):
        part_of({"kind": "gouraud"})


def test_what_misses_is_empty_or_the_background() -> None:
    looking = beams([[0, 0, 3], [3, 0, 3]], [0, 0, -1])
    world = quads([square(1, 0)], parts=MATT, e_sun=E_SUN)
    assert seen(world, looking)[:, 3].tolist() == [1, 0]
    assert seen(world, looking)[1].tolist() == [0, 0, 0, 0]
    behind = dataclasses.replace(world, background=lambda directions: 2 * np.abs(directions))
    assert seen(behind, looking)[1].tolist() == [0, 0, 2, 1]


def test_what_does_not_fit_is_refused() -> None:
    world, looking = quads([square(1, 0)]), beams([0, 0, 3], [0, 0, -1])
    with pytest.raises(InputError, match="strata"):
        render(world, looking, CENTRE, Options(3))
    with pytest.raises(InputError, match="positions"):
        render(world, looking, np.zeros((0, 2)))
    for name, value in {"vertices": np.zeros((3, 2)), "faces": np.array([[0, 1, 9]]), "normals": np.zeros((1, 3, 3)),
                        "colour": np.zeros((2, 4))}.items():  # fmt: skip
        with pytest.raises(InputError, match=name):
            dataclasses.replace(world, **{name: value})
    with pytest.raises(InputError, match="image"):
        dataclasses.replace(world, parts=((1.0, Surroundings(np.zeros((4, 8)), 0, 1, 1)),))
    wrong = Measured("angles", (np.arange(2.0),) * 4, np.zeros((2, 2, 3, 2, 3)))
    with pytest.raises(InputError, match="values"):
        dataclasses.replace(world, parts=((1.0, wrong),))
