"""Silhouettes of the directional textures' reference: before the sky, before the subject itself, and nowhere else."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.reference import directional_edges as edges
from renderer.reference.directional_mesh import Subject
from renderer.world.camera import Orthographic, rays
from tests.reference.directional import ball, quads, square

SIDE, WIDE = 20, 4.0


def looking(place: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Straight down, 0.2 m a pixel."""
    camera = Orthographic(centre=(0.0, 0.0, 3.0), direction=(0.0, 0.0, -1.0), up=(0.0, 1.0, 0.0), width=WIDE)
    return rays(camera, SIDE, SIDE, place)


def middles() -> tuple[np.ndarray, np.ndarray]:
    across = (np.arange(SIDE) + 0.5) / SIDE * WIDE - WIDE / 2
    return np.meshgrid(across, -across)


def test_a_plate_over_the_ground_ends_where_it_does() -> None:
    """The plate's edge, 0.9 m from the middle, runs through pixels of 0.8 to 1 m; the ground goes on beyond the
    picture."""
    x, y = middles()
    found = edges.silhouettes(Subject(quads([square(9, 0), square(0.9, 0.5)])), looking, 0.1)
    size = np.maximum(np.abs(x), np.abs(y))
    assert (found == (np.abs(size - 0.9) < 0.1)).all()


def test_parts_that_hardly_stand_over_one_another_have_none() -> None:
    stacked = Subject(quads([square(9, 0), square(0.9, 0.05)]))
    assert not edges.silhouettes(stacked, looking, 0.1).any()


def test_a_ball_ends_before_the_sky_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """However steeply its flanks fall; by depth alone they would be edges, too."""
    x, y = middles()
    away = np.abs(np.hypot(x, y) - 1)
    found = edges.silhouettes(Subject(ball()), looking, 0.05)
    assert found[away < 0.03].all()
    assert not found[away > 0.25].any()
    apart = lambda one, other, step: np.nan_to_num(np.abs(one[..., 2] - other[..., 2])) > step  # noqa: E731
    monkeypatch.setattr(edges, "_parted", apart)
    assert edges.silhouettes(Subject(ball()), looking, 0.05)[away > 0.25].any()
