"""Small subjects and single rays for tests of the directional textures' reference."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import trimesh

from renderer.reference.directional import Options, render
from renderer.reference.directional_world import DirectionalWorld

CENTRE = np.array([[0.5, 0.5]])
E_SUN = (10.0, 8.0, 6.0)
Looking = Callable[[tuple[float, float]], tuple[np.ndarray, np.ndarray]]


def unit(vectors: Any) -> np.ndarray:
    array = np.asarray(vectors, np.float64)
    return array / np.linalg.norm(array, axis=-1, keepdims=True)


def quads(corners: Sequence[Any], colour: float = 0.5, **light: Any) -> DirectionalWorld:
    """Flat quadrilaterals (Q, 4, 3), each in the turn that its normal asks for."""
    places = np.asarray(corners, np.float64)
    normal = unit(np.cross(places[:, 1] - places[:, 0], places[:, 2] - places[:, 0]))
    first = 4 * np.arange(len(places))[:, None]
    faces = np.concatenate([first + [0, 1, 2], first + [0, 2, 3]])
    normals = np.repeat(np.concatenate([normal, normal])[:, None], 3, axis=1)
    return DirectionalWorld(places.reshape(-1, 3), faces, normals, np.full((len(faces), 3), colour), **light)


def square(half: float, height: float) -> list[list[float]]:
    """A level square that faces up."""
    return [[-half, -half, height], [half, -half, height], [half, half, height], [-half, half, height]]


def ball(colour: float = 0.5, divisions: int = 5, **light: Any) -> DirectionalWorld:
    """A smooth ball of radius 1 about the origin."""
    mesh = trimesh.creation.icosphere(subdivisions=divisions)
    faces = np.asarray(mesh.faces)
    vertices = unit(mesh.vertices)
    return DirectionalWorld(vertices, faces, vertices[faces], np.full((len(faces), 3), colour), **light)


def beams(origins: Any, directions: Any) -> Looking:
    """One row of rays, whatever the position."""
    o, d = np.broadcast_arrays(np.atleast_2d(np.asarray(origins, np.float64)), unit(np.atleast_2d(directions)))
    return lambda place: (o[None], d[None])


def seen(world: DirectionalWorld, looking: Looking, strata: int = 2, times: int = 1) -> np.ndarray:
    """Radiance (M, 4) along some rays."""
    return np.asarray(render(world, looking, np.tile(CENTRE, (times, 1)), Options(strata)).radiance[0])
