"""Moving surfaces: what each motion keeps, and a shell that follows by what moved alone."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from renderer.core.params import bake_arguments
from renderer.shells.animation import Bend, Bump, MovingShell, NoiseMotion, Still, Twist, bent, deformed, twisted
from renderer.shells.base_mesh import BaseMesh
from renderer.shells.extrusion import Extrusion
from renderer.shells.shell import build_shell
from renderer.shells.shell_bake import bake_shell, shell_of
from renderer.shells.surfaces import Sphere, Tube, bake_surface, surface_of
from renderer.world.mesh_normals import vertex_normals

MOTIONS = [NoiseMotion(), Bend(), Twist(), Bump()]


def named(value: Any) -> str:
    return str(getattr(value, "kind", value))


def volume(vertices: np.ndarray, faces: np.ndarray) -> float:
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return float(np.einsum("fk,fk->", a, np.cross(b, c)) / 6)


@pytest.mark.parametrize("motion", MOTIONS, ids=named)
def test_a_motion_comes_back_and_moves_in_between(motion: Any) -> None:
    mesh = Tube().mesh()
    start, later, back = (deformed(mesh, motion, share * motion.period) for share in (0, 0.3, 1))
    np.testing.assert_allclose(start, back, atol=1e-12)
    assert abs(later - start).max() > 0.02
    np.testing.assert_array_equal(deformed(mesh, Still(), 3.0), mesh.vertices)


def test_bending_keeps_volume_and_the_axis_length() -> None:
    """Fibres on the outer side grow as those on the inner side shrink: a ball's volume stays (Barr 1984)."""
    ball = Sphere(divisions=24).mesh()
    low = ball.vertices[:, 2].min()
    turned = bent(ball.vertices, 1.2)
    assert volume(turned, ball.faces) == pytest.approx(volume(ball.vertices, ball.faces), rel=1e-3)
    axis = np.stack([np.zeros(101), np.zeros(101), np.linspace(low, -low, 101)], axis=-1)
    arc = bent(axis, 1.2)
    assert np.linalg.norm(np.diff(arc, axis=0), axis=1).sum() == pytest.approx(-2 * low, rel=1e-4)
    np.testing.assert_allclose(arc[0], axis[0])
    end = arc[-1] - arc[-2]
    assert math.atan2(end[0], end[2]) == pytest.approx(1.2, abs=0.01)


def test_twisting_keeps_volume_heights_and_radii() -> None:
    ball = Sphere(divisions=24).mesh()
    turned = twisted(ball.vertices, 2.0)
    assert volume(turned, ball.faces) == pytest.approx(volume(ball.vertices, ball.faces), rel=2e-3)
    np.testing.assert_array_equal(turned[:, 2], ball.vertices[:, 2])
    np.testing.assert_allclose(np.hypot(*turned[:, :2].T), np.hypot(*ball.vertices[:, :2].T), atol=1e-12)
    top, foot = ball.vertices[:, 2].argmax() - 1, ball.vertices[:, 2].argmin() - 1
    for place in (top, foot):
        turn = 2.0 * ball.vertices[place, 2] / np.ptp(ball.vertices[:, 2])
        expected = ball.vertices[place, 0] * math.cos(turn) - ball.vertices[place, 1] * math.sin(turn)
        assert turned[place, 0] == pytest.approx(expected)


def test_noise_has_its_amplitude() -> None:
    mesh = Sphere(radius=2, divisions=20).mesh()
    motion = NoiseMotion(amplitude=0.1, size=0.5)
    moved = [deformed(mesh, motion, time) - mesh.vertices for time in (0.0, 1.1, 2.3, 3.9)]
    np.testing.assert_allclose(np.sqrt(np.mean(np.square(moved), axis=(0, 1))), 0.1, rtol=0.1)


def test_a_bump_is_local() -> None:
    mesh = Sphere(divisions=16).mesh()
    moved = deformed(mesh, Bump(height=0.1, radius=0.3), 0.0) - mesh.vertices
    middle = np.array([0.4 * 1.2, 0, 0])
    away = np.linalg.norm(mesh.vertices - middle, axis=1)
    assert (moved[away > 0.3] == 0).all()
    along = np.einsum("vk,vk->v", moved, vertex_normals(mesh.vertices, mesh.faces))
    assert 0.05 < along.max() <= 0.1
    np.testing.assert_allclose(np.linalg.norm(moved, axis=1), along, atol=1e-12)


@pytest.mark.parametrize("motion", MOTIONS, ids=named)
def test_the_shell_follows_by_what_moved_alone(motion: Any) -> None:
    """From any earlier time, the shell is the one that would be built now; few cells change under a bump."""
    extrusion = Extrusion(thickness=0.05)
    surface = bake_surface(bake_arguments(Sphere(divisions=8)), {}, lambda *_: None)
    baked = bake_shell(bake_arguments(extrusion), {"surface": surface}, lambda *_: None)
    moving = MovingShell(surface, baked, extrusion)
    assert len(moving.move(Still(), 0.0)) == 0
    moving.move(motion, 1.0)
    changed = moving.move(motion, 1.1)
    mesh = surface_of(surface)
    vertices = deformed(mesh, motion, 1.1)
    offset = 0.05 * vertex_normals(vertices, mesh.faces)
    built = build_shell(BaseMesh(vertices, mesh.faces, mesh.corner_uv), offset)
    for name in ("positions", "planes", "to_texture", "volumes"):
        np.testing.assert_allclose(getattr(moving.shell, name), getattr(built, name), rtol=1e-9, atol=1e-9)
    share = len(changed) / len(built.tets)
    assert 0.05 < share < 0.4 if motion.kind == "bump" else share > 0.9
    now, shell = moving.arrays(surface, baked)
    np.testing.assert_allclose(shell_of(shell).to_texture, built.to_texture, rtol=1e-9, atol=1e-9)
    np.testing.assert_array_equal(now["vertices"], vertices)
    np.testing.assert_array_equal(now["normals"], vertex_normals(vertices, mesh.faces))
    assert len(moving.move(motion, 1.1)) == 0
