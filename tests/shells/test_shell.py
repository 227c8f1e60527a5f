"""Tetrahedra fill the shell: volumes add up, shared faces match, each point lies in one cell, maps are exact."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.shells.base_mesh import BaseMesh
from renderer.shells.shell import BASE, RIM, TOP, Shell, build_shell, update_shell
from renderer.world.mesh_normals import vertex_normals
from tests.shells.meshes import ALL, SOUND, smeared

THICKNESS = 0.08


def shell_over(mesh: BaseMesh, thickness: float = THICKNESS) -> Shell:
    return build_shell(mesh, thickness * vertex_normals(mesh.vertices, mesh.faces))


SHELLS = {name: shell_over(mesh) for name, mesh in ALL.items()}


def under(triangles: np.ndarray) -> np.ndarray:
    """Volume between triangles (..., 3, 3) and the origin, by the divergence theorem."""
    a, b, c = (triangles[..., k, :] for k in range(3))
    return np.einsum("...k,...k->...", a, np.cross(b, c)) / 6


def prism_skin(mesh: BaseMesh, shell: Shell) -> np.ndarray:
    """The eight triangles around each prism, outwards: (F, 8, 3, 3). A side is cut from its lower vertex upwards."""
    count = len(mesh.vertices)
    skin = [mesh.faces[:, ::-1], mesh.faces + count]
    for k in range(3):
        a, b = mesh.faces[:, k], mesh.faces[:, (k + 1) % 3]
        skin.append(np.stack([a, b, np.where(a < b, b, a) + count], axis=1))
        skin.append(np.stack([np.where(a < b, a, b), b + count, a + count], axis=1))
    return shell.positions[np.stack(skin, axis=1)]


@pytest.mark.parametrize("name", ALL)
def test_cells_fill_each_prism(name: str) -> None:
    shell = SHELLS[name]
    expected = under(prism_skin(ALL[name], shell)).sum(axis=1)
    np.testing.assert_allclose(shell.volumes.reshape(-1, 3).sum(axis=1), expected, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("name", SOUND)
def test_cells_fill_the_shell(name: str) -> None:
    """What the skin around all cells holds is the cells' volume; the skin is known from the base mesh alone."""
    mesh, shell = SOUND[name], SHELLS[name]
    start, end = mesh.faces.ravel(), np.roll(mesh.faces, -1, axis=1).ravel()
    inner = {(int(b), int(a)) for a, b in zip(start, end)}
    rim = np.array([(int(a), int(b)) not in inner for a, b in zip(start, end)]).reshape(-1, 3)
    skin = under(prism_skin(mesh, shell))
    whole = skin[:, :2].sum() + skin[:, 2:].reshape(-1, 3, 2)[rim].sum()
    assert len(shell.inverted()) == len(shell.flat()) == 0
    assert abs(shell.volumes).sum() == pytest.approx(whole, rel=1e-9)


@pytest.mark.parametrize("name", ALL)
def test_shared_faces_match(name: str) -> None:
    """Across a face lies a tetrahedron that holds the same three vertices and names this one across the same face."""
    shell = SHELLS[name]
    cell, corner = np.nonzero(shell.neighbour >= 0)
    other = shell.neighbour[cell, corner]
    names_back = shell.neighbour[other] == cell[:, None]
    assert (names_back.sum(axis=1) == 1).all()
    back = names_back.argmax(axis=1)
    rest = np.array([[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]])
    here = np.take_along_axis(shell.tets[cell], rest[corner], axis=1)
    np.testing.assert_array_equal(here, np.take_along_axis(shell.tets[other], rest[back], axis=1))
    if name in SOUND:
        np.testing.assert_array_equal(shell.planes[cell, corner], -shell.planes[other, back])
    for code, lift in ((BASE, 0), (TOP, len(ALL[name].vertices))):
        cell, corner = np.nonzero(shell.neighbour == code)
        outer = np.take_along_axis(shell.tets[cell], rest[corner], axis=1) - lift
        np.testing.assert_array_equal(outer, np.sort(ALL[name].faces, axis=1))
    edges = np.sort(np.stack([ALL[name].faces, np.roll(ALL[name].faces, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    _, uses = np.unique(edges, axis=0, return_counts=True)
    alone = uses[uses != 2] - np.where(uses[uses != 2] > 2, 2, 0)
    assert (shell.neighbour == RIM).sum() == 2 * alone.sum()


def holding(shell: Shell, cells: np.ndarray, point: np.ndarray) -> np.ndarray:
    """Which of `cells` (N, K) hold each of the points (N, M, 3): (N, M, K)."""
    distance = np.einsum("nkcx,nmx->nmkc", shell.planes[cells][..., :3], point) + shell.planes[cells][:, None, :, :, 3]
    return distance.max(axis=-1) < 0


@pytest.mark.parametrize("name", ["triangle", "box", "torus", "lumps", "spikes"])
def test_a_point_of_a_prism_lies_in_one_cell(name: str) -> None:
    """Inside is where the skin's solid angle is 4 pi (van Oosterom and Strackee 1983), which knows no cells."""
    mesh, shell = ALL[name], SHELLS[name]
    prisms = np.setdiff1d(np.arange(len(mesh.faces)), shell.inverted())[:200]
    skin = prism_skin(mesh, shell)[prisms]
    low, high = skin.min(axis=(1, 2)), skin.max(axis=(1, 2))
    points = low[:, None] + (high - low)[:, None] * np.random.default_rng(5).random((len(prisms), 40, 3))
    a, b, c = np.moveaxis(skin[:, None] - points[:, :, None, None], -2, 0)
    la, lb, lc = (np.linalg.norm(v, axis=-1) for v in (a, b, c))
    dot = lambda x, y: np.einsum("...k,...k->...", x, y)  # noqa: E731
    angle = 2 * np.arctan2(dot(a, np.cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb)
    inside = angle.sum(axis=-1) > 2 * np.pi
    cells = 3 * prisms[:, None] + np.arange(3)
    assert inside.sum() > 2 * len(prisms)
    np.testing.assert_array_equal(holding(shell, cells, points).sum(axis=-1), inside)


@pytest.mark.parametrize("name", ALL)
def test_the_map_is_exact_at_the_corners(name: str) -> None:
    shell = SHELLS[name]
    sound = shell.volumes != 0
    points = shell.positions[shell.tets]
    mapped = np.einsum("nab,nkb->nka", shell.to_texture[..., :3], points) + shell.to_texture[:, None, :, 3]
    np.testing.assert_allclose(mapped[sound], shell.texture[sound], atol=1e-10)
    assert np.isfinite(shell.to_texture).all()
    assert np.isfinite(shell.planes).all()


def test_texture_is_the_corners_own() -> None:
    """Each corner of a cell has the u and v of its face's corner at that vertex, and the w of its side."""
    mesh = ALL["cube sphere"]
    shell, count = SHELLS["cube sphere"], len(mesh.vertices)
    for face in (0, 17, 611):
        for cell in range(3 * face, 3 * face + 3):
            for vertex, uvw in zip(shell.tets[cell], shell.texture[cell]):
                corner = list(mesh.faces[face]).index(vertex % count)
                np.testing.assert_array_equal(uvw, (*mesh.corner_uv[face, corner], vertex >= count))


def test_what_is_unusual_is_counted() -> None:
    assert SHELLS["fins"].edges.crowded == 1
    assert SHELLS["moebius"].edges.turned == 2
    assert SHELLS["tube"].edges.open == 24
    for name in ("box", "torus", "globe"):
        assert SHELLS[name].edges.open == SHELLS[name].edges.crowded == SHELLS[name].edges.turned == 0
    np.testing.assert_array_equal(SHELLS["smeared"].flat_uv, np.arange(16))
    assert len(SHELLS["plane"].flat_uv) == 0


def test_inverted_prisms_are_found() -> None:
    """A bowl z = 2 r2 bends with radius 1/4 at its bottom: a shell of 0.1 fits there, one of 0.6 turns inside out."""
    bowl = ALL["thick bowl"]
    assert len(shell_over(bowl, 0.1).inverted()) == 0
    turned = shell_over(bowl, 0.6).inverted()
    assert 0 < len(turned) < len(bowl.faces)
    middle = bowl.vertices[bowl.faces[turned]].mean(axis=1)
    assert np.hypot(*middle[:, :2].T).max() < 0.9
    assert len(shell_over(bowl, -0.1).inverted()) == len(bowl.faces), "all lie at the triangles' backs"


def test_a_shell_without_thickness_is_flat_and_finite() -> None:
    shell = shell_over(smeared(), 0.0)
    assert len(shell.flat()) == len(shell.tets)
    assert np.isfinite(shell.planes).all()
    assert np.isfinite(shell.to_texture).all()


def test_only_what_moved_is_computed_again() -> None:
    mesh = ALL["torus"]
    shell = SHELLS["torus"]
    positions = shell.positions.copy()
    touched = np.array([7, len(mesh.vertices) + 100])
    positions[touched] += (0.01, -0.02, 0.015)
    fresh, changed = update_shell(shell, positions)
    np.testing.assert_array_equal(changed, np.flatnonzero(np.isin(shell.tets, touched).any(axis=1)))
    assert 0 < len(changed) < 40
    offset = positions[len(mesh.vertices) :] - positions[: len(mesh.vertices)]
    whole = build_shell(BaseMesh(positions[: len(mesh.vertices)], mesh.faces, mesh.corner_uv), offset)
    np.testing.assert_array_equal(fresh.positions, positions)
    for name in ("planes", "to_texture", "volumes"):
        np.testing.assert_allclose(getattr(fresh, name), getattr(whole, name), rtol=1e-9, atol=1e-9)
        kept = np.delete(np.arange(len(shell.tets)), changed)
        np.testing.assert_array_equal(getattr(fresh, name)[kept], getattr(shell, name)[kept])
    same, none = update_shell(fresh, positions)
    assert len(none) == 0
    np.testing.assert_array_equal(same.planes, fresh.planes)


def test_a_cut_by_place_and_not_by_number_would_leave_cracks() -> None:
    """The spoiled variant: cutting each prism in the order of its own corners makes sides that do not match."""
    mesh = ALL["torus"]
    shell = SHELLS["torus"]
    corners = np.concatenate([mesh.faces, mesh.faces + len(mesh.vertices)], axis=1)
    spoiled = corners[:, [0, 1, 2, 5, 0, 1, 4, 5, 0, 3, 4, 5]]
    assert unmatched(shell.tets) == 2 * len(mesh.faces)
    assert unmatched(spoiled.reshape(-1, 4)) > 2 * len(mesh.faces) + 100


def unmatched(tets: np.ndarray) -> int:
    """How many faces belong to one tetrahedron alone."""
    faces = np.concatenate([np.delete(tets, k, axis=1) for k in range(4)])
    _, uses = np.unique(np.sort(faces, axis=1), axis=0, return_counts=True)
    return int((uses == 1).sum())
