"""Points of a subject: spread evenly, found again from a place on their triangle, shared by triangles too small."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from renderer.directional.cloud import _middles, bake_cloud, part_of, rounded_positions
from renderer.directional.subjects import box_of


def silent(share: float, words: str) -> None:
    pass


def subject(vertices: np.ndarray, faces: np.ndarray, two_sided: bool = False) -> dict[str, np.ndarray]:
    """A subject as baked, each face with its own normal and a colour by its number."""
    normal = np.cross(vertices[faces[:, 1]] - vertices[faces[:, 0]], vertices[faces[:, 2]] - vertices[faces[:, 0]])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    shade = np.linspace(0.1, 0.9, len(faces))
    return {
        "vertices": vertices, "faces": faces.astype(np.int32), "normals": np.repeat(normal[:, None], 3, axis=1),
        "colour": np.repeat(shade[:, None], 3, axis=1), "two_sided": np.asarray(two_sided),
        "box": box_of(vertices, faces),
    }


def square(cells: int, two_sided: bool = False) -> dict[str, np.ndarray]:
    """The unit square in z = 0, of 2 cells^2 triangles."""
    x, y = np.meshgrid(np.arange(cells + 1) / cells, np.arange(cells + 1) / cells)
    number = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
    a, b, c, d = number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]
    faces = np.stack([np.stack([a, b, c], -1), np.stack([a, c, d], -1)], axis=2).reshape(-1, 3)
    return subject(np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3), faces, two_sided)


@pytest.mark.parametrize("cuts", [1, 2, 3, 7, 200, 4095])
def test_each_part_of_a_triangle_is_found_from_its_middle(cuts: int) -> None:
    place = np.arange(cuts**2) if cuts <= 200 else np.random.default_rng(1).integers(0, cuts**2, 20_000)
    u, v = _middles(place, np.full(len(place), cuts))
    assert (u > 0).all()
    assert (v > 0).all()
    assert (u + v < 1).all()
    assert (part_of(u, v, np.full(len(place), cuts)) == place).all()
    # Swapped weights name the mirrored part: only those on the triangle's own mirror line stay.
    assert (part_of(v, u, np.full(len(place), cuts)) != place).sum() >= len(place) - cuts - 2 * (cuts > 200)


def test_a_place_has_the_point_whose_part_holds_it() -> None:
    rng = np.random.default_rng(2)
    u, v = rng.uniform(0, 1, (2, 5000))
    turned = u + v > 1
    u[turned], v[turned] = 1 - u[turned], 1 - v[turned]
    cuts = np.full(5000, 6)
    middle = np.stack(_middles(part_of(u, v, cuts), cuts))
    # No part of six reaches farther from its middle than two thirds of a sixth along either side.
    assert np.abs(middle - [u, v]).max() <= 2 / 3 / 6 + 1e-12


def test_points_are_as_many_as_asked_for_and_evenly_spread() -> None:
    cloud = bake_cloud({"points": 20_000}, {"subject": square(5)}, silent)
    count = len(cloud["position"])
    assert count == pytest.approx(20_000, rel=0.05)
    away, _ = cKDTree(cloud["position"]).query(cloud["position"], k=2)
    assert away[:, 1].max() < 1.3 * float(cloud["spacing"])
    assert away[:, 1].min() > 0.5 * float(cloud["spacing"])
    assert float(cloud["spacing"]) == pytest.approx(20_000**-0.5)


def test_small_triangles_share_points() -> None:
    made = square(60)
    cloud = bake_cloud({"points": 1800}, {"subject": made}, silent)
    assert len(cloud["position"]) == pytest.approx(1800, rel=0.25)
    first = cloud["first"][:, 0]
    assert (np.bincount(first, minlength=len(cloud["position"])) > 0).all()
    # Each triangle's point is near: within some spacings of its own middle.
    away = made["vertices"][made["faces"]].mean(axis=1) - cloud["position"][first]
    assert np.linalg.norm(away, axis=1).max() < 6 * float(cloud["spacing"])
    assert np.quantile(np.linalg.norm(away, axis=1), 0.9) < 2 * float(cloud["spacing"])
    # Colour is kept: the mean over all triangles that have a point, by area.
    weight = np.bincount(first, minlength=len(cloud["position"]))
    assert (cloud["colour"][:, 0] * weight).sum() == pytest.approx(made["colour"][:, 0].sum(), rel=1e-6)


def test_two_sided_subjects_have_points_on_both_sides() -> None:
    cloud = bake_cloud({"points": 5000}, {"subject": square(5, two_sided=True)}, silent)
    half = len(cloud["position"]) // 2
    assert 2 * half == pytest.approx(5000, rel=0.05)
    assert (cloud["position"][:half] == cloud["position"][half:]).all()
    assert (cloud["normal"][:half] == [0, 0, 1]).all()
    assert (cloud["normal"][half:] == [0, 0, -1]).all()
    assert (cloud["first"][:, 1] == cloud["first"][:, 0] + half).all()


@pytest.mark.parametrize("bits", [8, 10, 12, 16])
def test_positions_are_rounded_to_their_bits(bits: int) -> None:
    box = np.array([(-1.0, 0.0, 2.0), (1.0, 3.0, 2.5)])
    place = box[0] + np.random.default_rng(3).uniform(0, 1, (50_000, 3)) * (box[1] - box[0])
    off = (rounded_positions(place, box, bits) - place) / (box[1] - box[0]) * (2**bits - 1)
    assert np.abs(off).max() <= 0.5 + 1e-9
    assert np.sqrt((off**2).mean()) == pytest.approx(12**-0.5, rel=0.02)  # of a step: an even error
