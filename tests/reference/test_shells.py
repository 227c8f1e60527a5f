"""The shells' truth: closed forms, and values made by others."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from renderer.core.errors import InputError, LimitError
from renderer.reference.shells import Options, Reference, render
from renderer.reference.shells_world import ShellsWorld
from tests.reference.shells import (
    CENTRE,
    PIXELS,
    SHARED,
    VALUES,
    Looking,
    alpha,
    beams,
    extrude,
    joined,
    prisms,
    slab,
    volume,
    volume_camera,
)

DOWN = (0.1, -0.2, -1.0)
ABOVE = (0.4, 0.6, 2.0)


def seen(world: ShellsWorld, looking: Looking, **options: int) -> np.ndarray:
    return render(world, looking, CENTRE, Options(**options)).radiance[0]


def relative(found: np.ndarray, right: np.ndarray) -> float:
    return float(np.sqrt(np.mean((found - right) ** 2) / np.mean(right**2)))


@pytest.mark.parametrize("name", ["disjoint", "overlapping"])
def test_prisms_are_crossed_exactly(name: str) -> None:
    world, looking, right = prisms(name)
    assert seen(world, looking) == pytest.approx(right, rel=1e-12)


def test_matter_of_what_overlaps_adds_up() -> None:
    """The same test refuses solids that replace each other."""
    world, looking, right = prisms("overlapping")
    alone = dataclasses.replace(world, tets=world.tets[:3], texture=world.texture[:3])
    rest = dataclasses.replace(world, tets=world.tets[3:], texture=world.texture[3:])
    front, behind = seen(alone, looking), seen(rest, looking)
    over = front + (1 - front[:, 3:]) * behind
    assert over[:, 3] == pytest.approx(right[:, 3], rel=1e-12), "what is hidden knows no order"
    assert np.abs(over[:, :3] - right[:, :3]).max() > 0.01


@pytest.mark.parametrize(("interpolation", "budget"), [("nearest", 1e-7), ("extinction", 1e-6), ("straight", 2e-5)])
def test_the_shared_volume_is_seen_as_others_saw_it(interpolation: str, budget: float) -> None:
    """The values are float32: 6e-8. What is interpolated is off by its parts between borders, and theirs by 4096
    steps."""
    rows, columns = np.array(PIXELS).T[:, None]
    world = slab(volume(), 1 / 64, interpolation=interpolation)
    assert relative(seen(world, volume_camera(rows, columns)), VALUES[interpolation]) < budget


@pytest.mark.skipif(not SHARED.is_dir(), reason="the shared references are not beside this checkout")
@pytest.mark.parametrize(
    ("interpolation", "name", "budget"),
    [
        ("nearest", "voxel_constant_exact", 1e-7),
        ("extinction", "assoc_trilinear", 2e-6),
        ("straight", "straight_trilinear", 2e-5),
    ],
)
def test_the_shared_pictures_are_met(interpolation: str, name: str, budget: float) -> None:
    with np.load(SHARED / "d_volume_images.npz") as images:
        right = images[name].astype(np.float64)
    world = slab(volume(), 1 / 64, interpolation=interpolation)
    found = render(world, volume_camera(*np.mgrid[0:128, 0:128]), CENTRE).radiance
    assert relative(found, right) < budget


def test_constant_voxels_are_integrated_exactly() -> None:
    """Against every border of the lattice along a ray, sorted at once."""
    rng = np.random.default_rng(5)
    rgba = rng.random((5, 7, 6, 4)) * [1, 1, 1, 0.4]
    sides = np.array([1.0, 1.0, 0.5])
    world = slab(rgba, 0.1)
    o = np.column_stack([rng.random((40, 2)), np.full(40, 2.0)])
    aim = rng.random((40, 3)) * sides
    d = (aim - o) / np.linalg.norm(aim - o, axis=1, keepdims=True)
    right = np.zeros((40, 4))
    for n in range(40):
        borders = [(np.arange(c + 1) / c * s - o[n, k]) / d[n, k] for k, (c, s) in enumerate(zip((6, 7, 5), sides))]
        t = np.sort(np.concatenate(borders))
        middle = (o[n] + 0.5 * (t[1:] + t[:-1])[:, None] * d[n]) / sides * [6, 7, 5]
        inside = (middle >= 0).all(axis=1) & (middle < [6, 7, 5]).all(axis=1)
        i, j, k = middle[inside].astype(int).T
        depth = -np.log1p(-rgba[k, j, i, 3]) / 0.1 * np.diff(t)[inside]
        left = np.exp(-np.concatenate([[0.0], np.cumsum(depth)]))
        right[n] = [*((left[:-1] - left[1:]) @ rgba[k, j, i, :3]), 1 - left[-1]]
    assert seen(world, beams(o, d)) == pytest.approx(right, rel=1e-11, abs=1e-13)


def test_colour_is_weighted_by_what_it_hides() -> None:
    """Dufort's eqs. 5.1 and 5.2 with premultiplied colour: 0.43233, where the text's own sum gives 14 (errata
    002-1)."""
    world = slab([0.5, 0.5, 0.5, alpha(4.0, 0.5)], 0.5)
    assert seen(world, beams([0.4, 0.6, 2], [0, 0, -1]))[0, 0] == pytest.approx(0.43233, abs=5e-6)


def test_stacked_and_coinciding_shells_multiply() -> None:
    rgba = volume()[::8, ::8, ::8]
    one = slab(rgba, 0.1)
    through = 1 - seen(one, beams(ABOVE, DOWN))[0, 3]
    heap = joined(*(slab(rgba, 0.1, origin=0.7 * k * np.array([-0.1, 0.2, 1.0])) for k in range(4)))
    assert 0.1 < through < 0.9
    assert 1 - seen(heap, beams(np.array(ABOVE) - 4 * np.array(DOWN), DOWN))[0, 3] == pytest.approx(through**4)
    assert 1 - seen(joined(one, one, one), beams(ABOVE, DOWN))[0, 3] == pytest.approx(through**3)


def test_more_solids_in_a_place_than_there_is_room_for_are_refused() -> None:
    one = slab([1, 1, 1, 0.5])
    with pytest.raises(LimitError, match="share a place"):
        seen(joined(*[one] * 70), beams(ABOVE, DOWN))


def ball(level: int, inner: float, outer: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Corners, faces and tetrahedra of a shell round a sphere: an octahedron's faces split `level` times."""
    corners = np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)
    faces = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [1, 0, 5], [2, 1, 5], [3, 2, 5], [0, 3, 5]])
    for _ in range(level):
        edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
        unique, where = np.unique(edges, axis=0, return_inverse=True)
        a, b, c = faces.T
        ab, bc, ca = (len(corners) + where.reshape(3, -1)).reshape(3, -1)
        middle = corners[unique].sum(axis=1)
        corners = np.concatenate([corners, middle / np.linalg.norm(middle, axis=1, keepdims=True)])
        faces = np.concatenate([np.stack(f, axis=1) for f in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))])
    positions, tets = extrude(inner * corners, faces, (outer - inner) * corners)
    return positions, faces, tets


def chord(corners: np.ndarray, faces: np.ndarray, o: np.ndarray, d: np.ndarray) -> np.ndarray:
    """Length of rays inside a convex body."""
    a, b, c = (corners[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    slope, height = d @ normal.T, o @ normal.T - np.einsum("fi,fi->f", normal, a)
    t = -height / slope
    begin, end = np.where(slope < 0, t, -np.inf).max(axis=1), np.where(slope > 0, t, np.inf).min(axis=1)
    return np.maximum(end - begin, 0.0)


def test_a_ball_of_absorber_in_closed_form() -> None:
    inner, outer, sigma = 0.8, 1.0, 1.7
    positions, faces, tets = ball(3, inner, outer)
    place = np.zeros((len(tets), 4, 3)) + 0.5
    colour = np.array([0.2, 0.9, 0.4, alpha(sigma, 0.1)]).reshape(1, 1, 1, 4)
    rng = np.random.default_rng(2)
    impact = 0.98 * np.sqrt(rng.random(200))
    turn = 2 * np.pi * rng.random(200)
    o = np.column_stack([impact * np.cos(turn), impact * np.sin(turn), np.full(200, 3.0)])
    d = np.broadcast_to([0.0, 0.0, -1.0], o.shape)
    found = seen(ShellsWorld(positions, tets, place, colour, 0.1), beams(o, d))
    count = len(positions) // 2
    length = chord(positions[count:], faces, o, d) - chord(positions[:count], faces, o, d)
    assert found[:, 3] == pytest.approx(-np.expm1(-sigma * length), rel=1e-10), "between the two polyhedra"
    assert found[:, :3] == pytest.approx(found[:, 3:] * [0.2, 0.9, 0.4], rel=1e-12)
    round_one = 2 * (np.sqrt(outer**2 - impact**2) - np.sqrt(np.maximum(inner**2 - impact**2, 0)))
    assert relative(found[:, 3], -np.expm1(-sigma * round_one)) < 0.03, "512 faces for a sphere"


def test_a_furnace_is_even() -> None:
    """Matter that sends what is behind it cannot be told from nothing, in any interpolation."""
    rgba = volume()[::4, ::4, ::4]
    rgba[..., :3] = 1.0
    for interpolation in ("nearest", "straight", "extinction"):
        world = slab(rgba, 0.05, interpolation=interpolation, background=lambda d: np.ones((len(d), 3)))
        found: Reference = render(world, volume_camera(*np.mgrid[20:108:8, 20:108:8]), CENTRE)
        assert found.radiance[..., 3].max() > 0.5
        assert found.radiance[..., :3] == pytest.approx(1.0, abs=1e-7), "what is behind 1e-7 is left out"


def test_a_texture_repeats_or_ends() -> None:
    """Along u and v, not along w; the other way of wrapping is seen to differ."""
    rgba = np.zeros((2, 2, 4, 4))
    rgba[..., 3] = [0.1, 0.2, 0.3, 0.7]
    rgba[1, ..., 3] = 0.0
    twice = slab(rgba, wrap="repeat")
    twice = dataclasses.replace(twice, texture=twice.texture * [2, 1, 1])
    looking = beams(np.column_stack([np.arange(16) / 16 + 1 / 32, np.full(16, 0.4), np.full(16, 2.0)]), [0, 0, -1])
    right = np.repeat(1 - (1 - rgba[0, 0, :, 3]) ** 0.25, 2)
    assert seen(twice, looking)[:, 3] == pytest.approx(np.tile(right, 2))
    ends = np.where(np.arange(16) < 8, np.tile(right, 2), right[-1])
    assert seen(dataclasses.replace(twice, wrap="clamp"), looking)[:, 3] == pytest.approx(ends)


def test_wrong_worlds_are_named() -> None:
    world, looking = slab([1, 1, 1, 0.5]), beams(ABOVE, DOWN)
    for change, words in (
        ({"tets": world.tets + 99}, "tets"),
        ({"texture": world.texture[:2]}, "texture"),
        ({"colour": np.zeros((2, 2, 4))}, "colour"),
        ({"normal": np.zeros((2, 2, 2, 4))}, "normal"),
        ({"reference_length": 0.0}, "reference_length"),
        ({"sun": (0.0, 0.0, 2.0)}, "sun"),
    ):
        with pytest.raises(InputError, match=words):
            render(dataclasses.replace(world, **change), looking, CENTRE)
    with pytest.raises(InputError, match="positions"):
        render(world, looking, np.zeros((0, 2)))
    with pytest.raises(InputError, match="options"):
        render(world, looking, CENTRE, Options(sun_rays=0))
