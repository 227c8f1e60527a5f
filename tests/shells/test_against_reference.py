"""What is drawn beside the float64 reference of the same state, ray by ray at the pixels' centres."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from renderer.core.baking import bake_now
from renderer.core.cache import Cache
from renderer.core.params import validate
from renderer.shells.bakes import bakes
from renderer.shells.state import ShellsState
from renderer.shells.world_arrays import world_arrays
from renderer.truth_scenes import RENDER
from renderer.world.camera import rays
from tests.shells.conftest import PLAIN, even

Draw = Callable[..., np.ndarray]
SIZE = 24
CENTRE = np.array([[0.5, 0.5]])

GLOBE = {
    "surface": {"kind": "sphere", "radius": 0.6, "divisions": 4},
    "extrusion": {"thickness": 0.2},
    "camera": {"kind": "orbit", "target": [0, 0, 0], "distance": 3, "azimuth": 30, "elevation": 20,
               "field_of_view": 36},
}


def blobs() -> np.ndarray:
    """Smooth matter of changing colour and opacity, (8, 16, 16, 4)."""
    w, v, u = np.meshgrid(*((np.arange(n) + 0.5) / n for n in (8, 16, 16)), indexing="ij")
    turn = 2 * np.pi
    colour = 0.5 + 0.4 * np.stack([np.sin(turn * u), np.cos(turn * v), np.sin(turn * (u + w))], axis=-1)
    alpha = 0.25 * (0.5 + 0.5 * np.sin(turn * u) * np.cos(turn * 2 * v)) * np.sin(np.pi * w)
    return np.concatenate([colour, alpha[..., None]], axis=-1).astype(np.float32)


def tilted() -> np.ndarray:
    """Normals that turn, some as short as they would be if they disagreed, and a little glow, (8, 16, 16, 4)."""
    w, v, u = np.meshgrid(*((np.arange(n) + 0.5) / n for n in (8, 16, 16)), indexing="ij")
    normal = np.stack([np.sin(7 * u), np.cos(9 * v), 0.3 + w, 0 * u], axis=-1)
    normal[..., :3] *= (0.4 + 0.6 * u[..., None]) / np.linalg.norm(normal[..., :3], axis=-1, keepdims=True)
    return normal.astype(np.float32)


def reference(
    patch: dict[str, Any], colour: np.ndarray, normal: np.ndarray | None = None, **options: Any
) -> np.ndarray:
    state = validate(ShellsState, {**PLAIN, **patch})
    cache = Cache()
    arrays = {bake.name: bake_now(bake, cache) for bake in bakes(state)}
    arrays["texture"] = {
        "colour": colour,
        "normal": np.zeros(colour.shape, np.float32) if normal is None else normal,
        "material": np.ones(colour.shape[:3], np.uint8),
        "size": np.ones(3),
        "reference_length": np.array(0.1),
    }
    world = world_arrays(state, arrays)
    world.pop("background")
    looking = lambda place: rays(state.camera, SIZE, SIZE, place)  # noqa: E731
    options = {"light": state.light.kind, **options}
    return RENDER["shells"](world, looking, CENTRE, options, lambda share, words: None)["linear"]


def apart(found: np.ndarray, right: np.ndarray) -> float:
    return float(np.sqrt(np.mean((found - right) ** 2) / np.mean(right**2)))


@pytest.mark.parametrize("interpolation", ["extinction", "straight"])
def test_emission_and_absorption_over_a_sphere(draw: Draw, interpolation: str) -> None:
    """Within the half of a percent that is asked of the accurate technique."""
    patch = {**GLOBE, "voxels": {"interpolation": interpolation, "storage": "float"},
             "sampling": {"kind": "adaptive", "rate": 4.0, "jitter": 0.0, "most": 256}}  # fmt: skip
    found = draw(patch, blobs(), size=SIZE)
    right = reference(patch, blobs())
    assert apart(found, right) < 0.005
    assert apart(found, reference(patch, 0.97 * blobs())) > 0.01, "a little less matter is seen to differ"


def test_the_opaque_surface_faces_the_sun_everywhere(draw: Draw) -> None:
    """Through matter too thin to be seen. The face of another cell than the ray's last is off by 0.9, flat faces by
    0.08."""
    patch = {**GLOBE, "base": {"opaque": True, "colour": [0.8, 0.5, 0.2]}, "light": {"kind": "lambert"},
             "sun": {"kind": "direction", "azimuth": 60, "elevation": 35}}  # fmt: skip
    found = draw(patch, even(1e-6), size=SIZE)
    assert apart(found, reference(patch, even(1e-6), shadows=False)) < 1e-4


@pytest.mark.parametrize("interpolation", ["extinction", "straight"])
def test_matter_is_lit_by_its_own_normals(draw: Draw, interpolation: str) -> None:
    patch = {**GLOBE, "voxels": {"interpolation": interpolation, "storage": "float"}, "light": {"kind": "lambert"},
             "sun": {"kind": "direction", "azimuth": 60, "elevation": 35},
             "sampling": {"kind": "adaptive", "rate": 16.0, "lit": 0.0, "jitter": 0.0, "most": 256}}  # fmt: skip
    found = draw(patch, blobs(), tilted(), size=SIZE)
    assert apart(found, reference(patch, blobs(), tilted(), shadows=False)) < 0.005
    mirrored = tilted() * np.array([-1, 1, 1, 1], np.float32)
    assert apart(found, reference(patch, blobs(), mirrored, shadows=False)) > 0.1


@pytest.mark.parametrize("eye", [(0.7, 0.013, 0.021), (0.1, 0.03, 0.02)])
def test_from_inside_of_the_shell_and_of_its_hollow(draw: Draw, eye: tuple[float, float, float]) -> None:
    camera = {"kind": "look", "eye": eye, "target": [0.7, 0.5, 0.3], "up": [0, 0, 1], "field_of_view": 90}
    patch = {**GLOBE, "camera": camera, "sampling": {"kind": "adaptive", "rate": 4.0, "jitter": 0.0, "most": 256}}
    assert apart(draw(patch, blobs(), size=SIZE), reference(patch, blobs())) < 0.002
