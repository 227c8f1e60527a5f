"""Meshes as 3D textures: what is inside, whatever the mesh."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import trimesh

from renderer.core.cache import AssetStore
from renderer.core.errors import AssetError
from renderer.shells.texture import winding
from renderer.shells.texture.block import Matter
from renderer.shells.texture.meshed import Meshed, knot
from renderer.shells.texture.winding import winding_numbers

BALL = trimesh.creation.icosphere(subdivisions=2, radius=1.0)


def solid_angles(mesh: trimesh.Trimesh, point: np.ndarray) -> float:
    """The winding number from the angles of the spherical triangles (L'Huilier): another formula, one by one."""
    total = 0.0
    for corners in mesh.triangles - point:
        a, b, c = corners / np.linalg.norm(corners, axis=1, keepdims=True)
        sides = [2 * math.asin(min(np.linalg.norm(p - q) / 2, 1.0)) for p, q in ((b, c), (c, a), (a, b))]
        half = sum(sides) / 2
        inner = math.prod(math.tan(max(x, 0.0) / 2) for x in (half, *(half - side for side in sides)))
        total += math.copysign(4 * math.atan(math.sqrt(max(inner, 0.0))), np.dot(np.cross(b - a, c - a), a))
    return total / (4 * math.pi)


def test_a_closed_mesh_winds_once_around_its_inside() -> None:
    rng = np.random.Generator(np.random.PCG64(1))
    points = rng.uniform(-2, 2, (300, 3))
    away = np.abs(np.linalg.norm(points, axis=1) - 1) > 0.05
    found = winding_numbers(BALL.vertices, BALL.faces, points[away])
    np.testing.assert_allclose(found, np.linalg.norm(points[away], axis=1) < 1, atol=0.04)


def test_an_open_mesh_winds_as_far_as_it_closes() -> None:
    half = trimesh.Trimesh(BALL.vertices, BALL.faces[BALL.triangles_center[:, 2] > 0], process=False)
    rng = np.random.Generator(np.random.PCG64(2))
    points = rng.uniform(-1.5, 1.5, (40, 3))
    exact = [solid_angles(half, point) for point in points]
    np.testing.assert_allclose(winding_numbers(half.vertices, half.faces, points), exact, atol=0.04)


def test_without_far_groups_the_sum_is_exact(monkeypatch: pytest.MonkeyPatch) -> None:
    """The tolerance above is that of the dipoles, not of a mistake."""
    monkeypatch.setattr(winding, "FAR", math.inf)
    monkeypatch.setattr(winding, "_wind", winding._wind.py_func)
    points = np.array([(0.2, 0.1, 0.3), (0.0, 0.0, 1.3), (0.9, -0.9, 0.2)])
    exact = [solid_angles(BALL, point) for point in points]
    np.testing.assert_allclose(winding_numbers(BALL.vertices, BALL.faces, points), exact, atol=1e-9)


@pytest.fixture
def made(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("UMBRAGE_CACHE", str(tmp_path))

    def make(mesh: trimesh.Trimesh, **said: object) -> Matter:
        digest = AssetStore().put(mesh.export(file_type="ply"), "mesh", "own.ply")
        return Meshed(asset=f"asset:{digest}", across=24, layers=24, **said).matter()

    return make


def test_overlapping_parts_are_filled_once(made) -> None:
    """An odd-even rule, or the thesis' flag, would leave the overlap empty."""
    first, second = trimesh.creation.box((2, 1, 1)), trimesh.creation.box((2, 1, 1))
    second.apply_translation((1, 0, 0))
    body = made(trimesh.util.concatenate([first, second]))
    inside = body.colour[..., 3]
    # 3 by 1 by 1 in a square of 1 less two margins.
    scale = (1 - 0.08) / 3
    np.testing.assert_allclose(inside.sum() / 24**3, 3 * scale**3, rtol=0.02)
    middle = inside[int(scale / 2 * 24), 12, 6:18]
    np.testing.assert_array_equal(middle, 1.0)


def test_an_open_mesh_is_filled_and_says_so(made) -> None:
    """A ball with a hole of a tenth of its height: nearly as full as the whole one."""
    whole = made(BALL).colour[..., 3].sum()
    keep = BALL.triangles_center[:, 2] < 0.8
    holed = made(trimesh.Trimesh(BALL.vertices, BALL.faces[keep], process=False))
    assert any("open" in note for note in holed.notes)
    assert 0.9 * whole < holed.colour[..., 3].sum() < 1.25 * whole


def test_a_ball_has_its_volume_and_its_normals(made) -> None:
    ball = made(BALL)
    volume = BALL.volume * (0.46 / 1.0) ** 3
    np.testing.assert_allclose(ball.colour[..., 3].sum() / 24**3, volume, rtol=0.02)
    centres = np.stack(np.meshgrid(*[(np.arange(24) + 0.5) / 24] * 3, indexing="ij")[::-1], axis=-1)
    away = centres - np.array([0.5, 0.5, 0.46])
    length = np.linalg.norm(away, axis=-1)
    near = np.abs(length - 0.46) < 1 / 24
    cosine = (away / length[..., None] * ball.normal[..., :3]).sum(axis=-1)[near]
    assert cosine.mean() > 0.97


def test_copies_repeat_and_a_sunk_mesh_stands_lower() -> None:
    once = Meshed(across=32, layers=8, copies=2).matter()
    np.testing.assert_array_equal(once.colour[:, :16, :16], once.colour[:, 16:, 16:])
    sunk = Meshed(across=16, layers=8, sunk=0.5).matter().colour[..., 3]
    assert sunk[0].sum() > once.colour[0, :16, :16, 3].sum()


def test_the_knot_is_closed() -> None:
    shape = knot()
    body = trimesh.Trimesh(shape.vertices, shape.faces)
    assert body.is_watertight
    assert body.volume > 0


def test_a_missing_mesh_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("UMBRAGE_CACHE", str(tmp_path))
    with pytest.raises(AssetError, match=r"texture\.asset"):
        Meshed(asset="asset:" + "0" * 64).matter()
