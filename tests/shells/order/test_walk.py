"""Order by walking: opacities add up along every ray, in the right order, whatever cells it crosses."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.core.baking import bake_now
from renderer.core.cache import Cache
from renderer.core.params import validate
from renderer.shells.bakes import sky_bake
from renderer.shells.probe import crossings
from renderer.shells.shell import build_shell
from renderer.shells.state import ShellsState
from renderer.shells.surfaces import Sphere
from renderer.world.camera import Orbit, rays
from renderer.world.mesh_normals import vertex_normals
from renderer.world.sky import sky_for
from renderer.world.sun import SunDirection, direction
from tests.shells.conftest import even, sigma

Draw = Callable[..., np.ndarray]
FILE = "shells/order/walk.glsl"
GLOBE = {
    "surface": {"kind": "sphere", "radius": 0.6, "divisions": 3},
    "extrusion": {"thickness": 0.15},
    "camera": {"kind": "orbit", "target": [0, 0, 0], "distance": 3, "azimuth": 30, "elevation": 9, "field_of_view": 40},
}


def hollow_sphere(origins: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """Length (N,) of rays inside of all cells over the sphere, by every plane of every cell."""
    mesh = Sphere(radius=0.6, divisions=3).mesh()
    planes = build_shell(mesh, 0.15 * vertex_normals(mesh.vertices, mesh.faces)).planes
    found = []
    for origin, ray in zip(origins, directions, strict=True):
        near, far = crossings(planes, origin, ray)
        found.append(np.where(far > near, far - near, 0.0).sum())
    return np.array(found)


def error(draw: Draw, size: int = 12) -> float:
    """Worst error of the opacity of an even absorber over a hollow sphere."""
    alpha = draw(GLOBE, even(0.02), size=size)[..., 3]
    origins, directions = rays(Orbit(**GLOBE["camera"]), size, size)
    length = hollow_sphere(origins.reshape(-1, 3), directions.reshape(-1, 3)).reshape(size, size)
    return float(np.abs(alpha - (1 - np.exp(-sigma(0.02) * length))).max())


def test_an_even_absorber_over_a_hollow_sphere(draw: Draw) -> None:
    assert error(draw) < 2e-4


def test_from_inside_of_a_cell(draw: Draw) -> None:
    look = {"kind": "look", "eye": [0.05, 0.02, 0.2], "target": [0.05, 0.02, 1], "up": [0, 1, 0], "field_of_view": 1}
    assert draw({"camera": look}, even(0.1))[..., 3] == pytest.approx(1 - np.exp(-sigma(0.1) * 0.3), abs=1e-4)


def test_what_is_near_hides_what_is_far(draw: Draw) -> None:
    """Two layers, red over blue, each of opacity 0.6 (erratum 002-3 asks for two coloured layers)."""
    block = even(1 - 0.4 ** (0.1 / 0.25), layers=2)
    block[0, ..., :3], block[1, ..., :3] = (0, 0, 1), (1, 0, 0)
    found = draw({"voxels": {"interpolation": "nearest", "storage": "float"}}, block)
    assert found[4, 4] == pytest.approx([0.6, 0.0, 0.24, 0.84], abs=2e-3)


def test_the_opaque_surface_ends_the_ray(draw: Draw) -> None:
    found = draw({"base": {"opaque": True, "colour": [0.2, 0.4, 0.8]}}, even(0.0))
    assert found[4, 4] == pytest.approx([0.2, 0.4, 0.8, 1.0], abs=1e-5)


def base_error(draw: Draw, size: int = 48) -> float:
    """Worst error of the light of a bare, opaque sphere of facets, whose normals are smooth, in its lit part."""
    sun = {"kind": "direction", "azimuth": 60.0, "elevation": 50.0}
    patch = {**GLOBE, "base": {"opaque": True, "colour": [1, 1, 1]}, "light": {"kind": "lambert"}, "sun": sun}
    found = draw(patch, even(0.0), size=size)[..., 1]
    mesh = Sphere(radius=0.6, divisions=3).mesh()
    corners, normals = mesh.vertices[mesh.faces], vertex_normals(mesh.vertices, mesh.faces)[mesh.faces]
    origins, directions = (part.reshape(-1, 1, 3) for part in rays(Orbit(**GLOBE["camera"]), size, size))
    edge_a, edge_b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    flat, from_corner = np.cross(edge_a, edge_b), origins - corners[:, 0]
    fall = (directions * flat).sum(-1)
    turned = np.cross(from_corner, directions)
    v, w = -(edge_b * turned).sum(-1) / fall, (edge_a * turned).sum(-1) / fall
    met = (v > 0.01) & (w > 0.01) & (v + w < 0.99) & (fall < 0)
    v, w = (np.where(met, part, 0.0)[..., None] for part in (v, w))
    smooth = ((1 - v - w) * normals[:, 0] + v * normals[:, 1] + w * normals[:, 2]) * met[..., None]
    towards = direction(SunDirection(azimuth=60.0, elevation=50.0))
    lit = met.any(1) & ((met * (flat @ towards)).sum(1) > 0)
    one = smooth.sum(1)[lit] / np.linalg.norm(smooth.sum(1)[lit], axis=1)[:, None]
    tables = bake_now(sky_bake(validate(ShellsState, {"scene": "shells"})), Cache())
    now = sky_for(tables, np.radians(50.0))
    exact = now.sun_irradiance[1] * np.maximum(one @ towards, 0) + now.sky_irradiance[1] * (1 + one[:, 2]) / 2
    return float(np.abs(found.reshape(-1)[lit] - exact / np.pi).max() / (exact.max() / np.pi))


def test_the_surface_has_the_light_of_its_smooth_normal(draw: Draw) -> None:
    assert base_error(draw) < 2e-3


@pytest.mark.parametrize(
    ("file", "right", "wrong"),
    [
        (FILE, "last = going ? tet : last;", "last = tet + 3;"),
        ("shells/base.glsl", "return normalize(sum);", "return -tet_texel(tet, 3).xyz;"),
    ],
)
def test_another_cells_normal_is_found(draw: Draw, spoil: Callable, file: str, right: str, wrong: str) -> None:
    with spoil(file, right, wrong):
        assert base_error(draw) > 0.01


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("enter = exit.t;", "enter = exit.t + 0.02;"),
        ("tet = tet_beyond(tet, face);", "tet = tet_beyond(tet, 3 - face);"),
    ],
)
def test_a_wrong_way_is_found(draw: Draw, spoil: Callable, right: str, wrong: str) -> None:
    with spoil(FILE, right, wrong):
        assert error(draw) > 0.01


def test_the_opaque_surface_has_two_sides(draw: Draw) -> None:
    """Seen from below, an open surface hides what stands on it."""
    camera = {"kind": "orthographic", "centre": [0, 0, 0], "direction": [0, 0, 1], "up": [0, 1, 0], "width": 1.6}
    found = draw({"camera": camera, "base": {"opaque": True, "colour": [0.2, 0.4, 0.8]}}, even(0.5))
    assert found[4, 4] == pytest.approx([0.2, 0.4, 0.8, 1.0], abs=1e-5)


def test_without_density_nothing_is_seen(draw: Draw) -> None:
    nothing = {"interpolation": "straight", "density": 0.0}
    assert not draw({"voxels": nothing, "light": {"kind": "lambert"}}, even(0.5)).any()
