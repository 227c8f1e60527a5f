"""Conflicts are found where they are and nowhere else, and shortening removes them without touching the rest."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linprog

from renderer.core.errors import LimitError
from renderer.shells import clamp
from renderer.shells.base_mesh import BaseMesh, side_by_side
from renderer.shells.clamp import LEAST, SLOPE, Prisms, facing_directions
from renderer.shells.clamp_kernels import close_prisms, overlapping
from renderer.shells.shell import build_shell
from renderer.shells.surfaces import Mushroom, Plane, Teapot
from renderer.world.mesh_normals import vertex_normals
from tests.shells.meshes import ALL, SOUND, corner, field, lumps, of_faces, torus


def moved(mesh: BaseMesh, by: tuple[float, float, float]) -> BaseMesh:
    return BaseMesh(mesh.vertices + by, mesh.faces, mesh.corner_uv)


def common_depth(a: np.ndarray, b: np.ndarray) -> float:
    """Radius [m] of the largest ball in both of two tetrahedra (4, 3), negative where they do not meet: a linear
    programme over the eight planes, which knows nothing of axes."""
    rows, limits = [], []
    for cell in (a, b):
        for k in range(4):
            p, q, r = np.delete(cell, k, axis=0)
            normal = np.cross(q - p, r - p)
            normal *= -np.sign(normal @ (cell[k] - p)) / np.linalg.norm(normal)
            rows.append([*normal, 1.0])
            limits.append(normal @ p)
    solved = linprog([0, 0, 0, -1], A_ub=rows, b_ub=limits, bounds=[(None, None)] * 4)
    return float(-solved.fun)


def test_overlaps_are_those_of_a_linear_programme() -> None:
    """Prisms at random places: they overlap where one of their cells shares a ball with one of the other's."""
    rng = np.random.default_rng(11)
    met = 0
    for _ in range(18):
        foot = rng.normal(size=(2, 3, 3))
        rise = np.cross(foot[:, 1] - foot[:, 0], foot[:, 2] - foot[:, 0])[:, None] + 0.2 * rng.normal(size=(2, 3, 3))
        foot[1] += 0.8 * rng.normal(size=3)
        prisms = np.concatenate([foot, foot + rise], axis=1)
        cells = prisms[:, [[0, 1, 2, 5], [0, 1, 4, 5], [0, 3, 4, 5]]]
        expected = max(common_depth(a, b) for a in cells[0] for b in cells[1])
        if abs(expected) < 1e-6:
            continue
        corners = np.arange(12).reshape(2, 6)
        close = close_prisms(prisms.reshape(-1, 3), corners, 1e-9, 9)
        found = overlapping(prisms, np.array([[0, 1]], np.int32), 1e-9)
        assert found[0] == (expected > 0), expected
        assert len(close) >= found[0], "nothing that overlaps is left out beforehand"
        met += expected > 0
    assert 5 < met < 13, met


@pytest.mark.parametrize("name", SOUND)
def test_a_sound_shell_has_no_conflicts(name: str) -> None:
    """Prisms that share a side, an edge or a corner only touch."""
    mesh = SOUND[name]
    prisms = Prisms(mesh.vertices, mesh.faces)
    offset = 0.08 * vertex_normals(mesh.vertices, mesh.faces)
    assert len(prisms.conflicts(offset)) == 0
    assert (prisms.clamp(offset).share == 1).all()


def test_facing_planes_meet_where_they_are_thick() -> None:
    """Two planes 1 m apart that face each other: shells of 0.49 m do not meet, those of 0.51 m do, everywhere."""
    below, above = Plane(divisions=3).mesh(), Plane(divisions=3).mesh()
    turned = BaseMesh(above.vertices + (0, 0, 1), above.faces[:, ::-1].copy(), above.corner_uv[:, ::-1].copy())
    both = side_by_side([below, turned])
    prisms = Prisms(both.vertices, both.faces)
    normal = vertex_normals(both.vertices, both.faces)
    assert len(prisms.conflicts(0.49 * normal)) == 0
    found = prisms.conflicts(0.51 * normal)
    assert len(found.inverted) == 0
    np.testing.assert_array_equal(found.prisms(), np.arange(36))
    clamped = prisms.clamp(0.8 * normal)
    assert len(clamped.left) == 0
    np.testing.assert_allclose(clamped.share, clamped.share[0])
    assert 0.42 < 0.8 * clamped.share[0] < 0.5


THICK = {
    "mushroom": (Mushroom(around=24, along=24).mesh(), 0.2),
    "bowl": (field(lambda x, y: 2.0 * (x**2 + y**2)), 0.5),
    "waves": (field(lambda x, y: 0.1 * np.sin(6 * x) * np.cos(5 * y), 20), 0.5),
    "torus": (torus(), 0.6),
    "lumps": (lumps(1, 0.05), 0.9),
    "spikes": (lumps(2, 0.4, 6), 0.3),
    "corner": (corner(), 3.0),
}


def offsets(mesh: BaseMesh, thickness: float) -> np.ndarray:
    way, _ = facing_directions(vertex_normals(mesh.vertices, mesh.faces), mesh.vertices, mesh.faces)
    return thickness * way


@pytest.mark.parametrize("name", THICK)
def test_clamping_leaves_no_conflict(name: str) -> None:
    """No cell is inside out afterwards, and no point of the shell lies in two cells."""
    mesh, thickness = THICK[name]
    offset = offsets(mesh, thickness)
    prisms = Prisms(mesh.vertices, mesh.faces)
    clamped = prisms.clamp(offset)
    if name not in ("lumps", "corner"):
        assert len(clamped.wanted) > 10
    assert len(clamped.left) == 0
    assert clamped.share.min() > LEAST
    shell = build_shell(mesh, offset * clamped.share[:, None])
    assert len(shell.inverted()) == len(shell.flat()) == 0
    assert most_cells_at_a_point(shell.positions, shell.tets, shell.planes) == 1


@pytest.mark.parametrize("name", sorted(ALL.keys() - {"moebius", "teapot"}))
def test_no_mesh_keeps_a_cell_inside_out(name: str) -> None:
    mesh = ALL[name]
    clamped = Prisms(mesh.vertices, mesh.faces).clamp(offset := offsets(mesh, 0.15))
    shell = build_shell(mesh, offset * clamped.share[:, None])
    assert len(shell.inverted()) == len(shell.flat()) == 0
    if name in SOUND:
        assert len(clamped.left) == 0


def most_cells_at_a_point(positions: np.ndarray, tets: np.ndarray, planes: np.ndarray) -> int:
    """The largest number of cells that hold one of 500 random points, each drawn inside some cell."""
    rng = np.random.default_rng(4)
    cells = rng.integers(0, len(tets), 500)
    weights = rng.dirichlet(np.ones(4), len(cells))
    points = np.einsum("nk,nkx->nx", weights, positions[tets[cells]])
    inside = np.ones((len(points), len(tets)), bool)
    for k in range(4):
        inside &= points @ planes[:, k, :3].T + planes[:, k, 3] < -1e-9
    return int(inside.sum(axis=1).max())


def test_without_clamping_points_lie_in_several_cells() -> None:
    """The spoiled variant of the test above."""
    mesh, thickness = THICK["mushroom"]
    shell = build_shell(mesh, offsets(mesh, thickness))
    assert most_cells_at_a_point(shell.positions, shell.tets, shell.planes) > 1


def test_clamping_is_local_and_gentle() -> None:
    """Under the mushroom's cap the shell is thinner; on the cap it is as thick as wanted."""
    mesh, thickness = THICK["mushroom"]
    clamped = Prisms(mesh.vertices, mesh.faces).clamp(offsets(mesh, thickness))
    top = mesh.vertices[:, 2] > 0.2
    under = (np.hypot(*mesh.vertices[:, :2].T) < 0.3) & (abs(mesh.vertices[:, 2]) < 0.1)
    assert (clamped.share[top] == 1).all()
    assert clamped.share[under].max() < 0.9
    a, b = mesh.faces.ravel(), np.roll(mesh.faces, -1, axis=1).ravel()
    rise = abs(clamped.share[a] - clamped.share[b]) * thickness
    assert (rise <= SLOPE * np.linalg.norm(mesh.vertices[a] - mesh.vertices[b], axis=1) * (1 + 1e-6)).all()


def test_where_the_mesh_meets_itself_no_length_helps() -> None:
    """Handle and spout of the teapot run through its body: these pairs are told apart, and all others go."""
    mesh = Teapot().mesh()
    prisms = Prisms(mesh.vertices, mesh.faces)
    clamped = prisms.clamp(offsets(mesh, 0.03))
    assert len(clamped.own) > 20
    assert len(clamped.left.inverted) == 0
    assert len(clamped.left.overlaps) < 0.15 * len(clamped.wanted.overlaps)
    apart = np.linalg.norm(
        mesh.vertices[mesh.faces[clamped.left.overlaps]].mean(axis=2)[:, None]
        - mesh.vertices[mesh.faces[clamped.own]].mean(axis=2)[None], axis=-1,
    ).max(axis=-1).min(axis=1)
    assert apart.max() < 0.1, "what is left lies beside what meets"


def test_a_direction_faces_every_triangle_where_one_can() -> None:
    """A blade's tip with a wide front and a narrow back: the mean normal looks behind the back."""
    tip, ring = (0, 0, 0), [(0, -1, 0), (0.1, 0, -1), (0, 1, 0), (-0.02, 1, -0.2)]
    mesh = of_faces([tip, *ring], [(0, 1, 2), (0, 2, 3), (0, 3, 4)])
    normal = vertex_normals(mesh.vertices, mesh.faces)
    found, turned = facing_directions(normal, mesh.vertices, mesh.faces)
    p, q, r = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    front = np.cross(q - p, r - p)
    front /= np.linalg.norm(front, axis=1, keepdims=True)
    assert (front @ normal[0]).min() < -0.5
    assert (front @ found[0]).min() > 0.05
    assert turned[0]
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1)
    kept, none = facing_directions(vertex_normals(torus().vertices, torus().faces), torus().vertices, torus().faces)
    assert not none.any()
    np.testing.assert_array_equal(kept, vertex_normals(torus().vertices, torus().faces))


def test_what_cannot_be_repaired_is_told() -> None:
    """At a Moebius strip's seam two triangles disagree: the shell stays broken there, and it says so."""
    mesh = ALL["moebius"]
    clamped = Prisms(mesh.vertices, mesh.faces).clamp(offsets(mesh, 0.05))
    assert 0 < len(clamped.left) <= 12


def test_too_many_prisms_together_are_refused_in_words(monkeypatch: pytest.MonkeyPatch) -> None:
    mesh, thickness = THICK["mushroom"]
    monkeypatch.setattr(clamp, "MOST_PAIRS", 500)
    with pytest.raises(LimitError, match="more than 500 pairs") as refused:
        Prisms(mesh.vertices, mesh.faces).clamp(offsets(mesh, thickness))
    assert refused.value.field == "extrusion.thickness"
