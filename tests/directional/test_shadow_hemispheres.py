"""Shadow hemispheres by rays: bodies whose shadows are known, the order of the bits, and work that is stopped."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.core.errors import Cancelled
from renderer.directional.frames import frames, quantised
from renderer.directional.hemisphere import hemisphere_of
from renderer.directional.shadow_hemispheres import (
    Caster,
    bake_shadows,
    cosine_weights,
    shadow_bits,
    unpacked,
    world_directions,
)


def quiet(share: float, words: str) -> None:
    """Progress that nobody hears."""


def wall() -> tuple[np.ndarray, np.ndarray]:
    """A wall in the plane x = 1, so wide that from near it it hides half of the sky, on a small floor."""
    far = 1e3
    corners = [[1, -far, -far], [1, far, -far], [1, far, far], [1, -far, far]]
    vertices = np.array([*corners, [0, 0, 0], [0.1, 0, 0], [0, 0.1, 0]])
    return vertices, np.array([[0, 1, 2], [0, 2, 3], [4, 5, 6]])


def ball() -> tuple[np.ndarray, np.ndarray]:
    """An octahedron."""
    vertices = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)
    return vertices, np.array([[i, j, k] for i in (0, 1) for j in (2, 3) for k in (4, 5)])


def dome(radius: float, height: float, corners: int = 256) -> tuple[np.ndarray, np.ndarray]:
    """A disc above the origin, and a triangle far below, which nothing sees."""
    turn = np.arange(corners) * 2 * np.pi / corners
    ring = np.stack([radius * np.cos(turn), radius * np.sin(turn), np.full(corners, height)], axis=1)
    vertices = np.concatenate([ring, [[0, 0, height], [0, 0, -2.0], [1, 0, -2.0], [0, 1, -2.0]]])
    faces = [[k, (k + 1) % corners, corners] for k in range(corners)]
    return vertices, np.array([*faces, [corners + 1, corners + 2, corners + 3]])


@pytest.mark.parametrize("count", [129, 513])
def test_weights_are_those_of_an_even_sky(count: int) -> None:
    layout = hemisphere_of(count)
    weights = cosine_weights(layout)
    assert weights.sum() == pytest.approx(1, rel=1e-12)
    assert (weights > 0).all()
    middles = layout.solid_angles() * layout.directions()[:, 2] / np.pi
    np.testing.assert_allclose(weights[:-1], middles[:-1], rtol=layout.step**2 / 6)


def test_a_convex_body_hides_nothing_from_its_own_faces() -> None:
    vertices, faces = ball()
    middles = vertices[faces].mean(axis=1)
    normals = quantised(middles / np.linalg.norm(middles, axis=1, keepdims=True))
    bits, openness = shadow_bits(Caster(vertices, faces), middles, normals, hemisphere_of(129), quiet)
    assert unpacked(bits, 129).all()
    np.testing.assert_allclose(openness, 1, rtol=1e-6)


@pytest.mark.parametrize("normal", [(0, 0, 1.0), (0.3, 0.2, -0.9), (0.6, -0.6, 0.5)])
def test_a_wall_hides_the_directions_that_point_at_it(normal: tuple[float, float, float]) -> None:
    """In the frame of the normal that the GPU will have, whatever it is."""
    layout = hemisphere_of(513)
    unit = quantised(np.array([normal]) / np.linalg.norm(normal))
    bits, _ = shadow_bits(Caster(*wall()), np.array([[-1.0, 3.0, 2.0]]), unit, layout, quiet)
    tangent, bitangent = frames(unit)
    local = layout.directions()
    towards = local @ np.concatenate([tangent, bitangent, unit])
    expected = towards[:, 0] <= 0
    clear = np.abs(towards[:, 0]) > 0.02  # the wall ends somewhere
    assert (unpacked(bits, 513)[0] == expected)[clear].all()
    assert 100 < expected.sum() < 413
    np.testing.assert_allclose(world_directions(unit, local)[0], towards, atol=1e-6)


@pytest.mark.parametrize("height", [0.5, 1.0, 2.0])
def test_a_disc_overhead_hides_its_form_factor(height: float) -> None:
    """1 / (1 + h^2) of an even sky for a disc of radius 1; rows of directions are 5.5 degrees apart."""
    caster = Caster(*dome(1.0, height))
    up = np.array([[0.0, 0.0, 1.0]])
    _, openness = shadow_bits(caster, np.zeros((1, 3)), up, hemisphere_of(513), quiet)
    edge = np.arctan(height)
    step = hemisphere_of(513).step
    most = np.sin(edge + step / 2) ** 2 - np.sin(edge - step / 2) ** 2
    assert openness[0] == pytest.approx(1 - 1 / (1 + height * height), abs=float(most))


def test_the_bake_takes_points_that_are_seen_alone() -> None:
    vertices, faces = wall()
    positions = np.array([[0, 0, 0], [9, 9, 9], [-5, 0, 0]], np.float32)
    normals = np.tile(np.array([0, 0, 1], np.float32), (3, 1))
    inputs = {
        "subject": {"vertices": vertices, "faces": faces},
        "cloud": {"position": positions, "normal": normals},
        "visibility": {"used": np.array([2, 0], np.int32)},
    }
    baked = bake_shadows({"directions": 129}, inputs, quiet)
    caster, used = Caster(vertices, faces), [2, 0]
    alone, openness = shadow_bits(caster, positions[used], normals[used], hemisphere_of(129), quiet)
    np.testing.assert_array_equal(baked["bits"], alone)
    np.testing.assert_array_equal(baked["openness"], openness)
    assert baked["bits"].shape == (2, 17)


def test_work_is_stopped_by_its_progress() -> None:
    def stop(share: float, words: str) -> None:
        raise Cancelled("enough")

    with pytest.raises(Cancelled):
        shadow_bits(Caster(*ball()), np.zeros((5, 3)), np.tile([0.0, 0.0, 1.0], (5, 1)), hemisphere_of(129), stop)
