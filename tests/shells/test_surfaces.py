"""Built-in surfaces: their sizes, counts and closedness, and texture coordinates that span every face."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import trimesh

from renderer.core.cache import AssetStore
from renderer.core.errors import AssetError, LimitError
from renderer.core.params import bake_arguments
from renderer.shells import surface_mapping
from renderer.shells.base_mesh import BaseMesh, flat_uv, from_corners
from renderer.shells.shell import build_shell
from renderer.shells.surface_mapping import mapped
from renderer.shells.surfaces import (
    Mushroom,
    Plane,
    Planks,
    Sphere,
    Teapot,
    Tube,
    UserMesh,
    Vase,
    bake_surface,
    surface_of,
)
from renderer.world.mesh import is_watertight
from renderer.world.mesh_normals import face_vectors, vertex_normals
from renderer.world.teapot import BODY, HANDLE, LID, SPOUT


def baked(surface: Any) -> BaseMesh:
    return surface_of(bake_surface(bake_arguments(surface), {}, lambda *_: None))


def volume(mesh: BaseMesh) -> float:
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    return float(np.einsum("fk,fk->", a, np.cross(b, c)) / 6)


def euler(mesh: BaseMesh) -> int:
    edges = np.sort(np.stack([mesh.faces, np.roll(mesh.faces, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    return len(mesh.vertices) - len(np.unique(edges, axis=0)) + len(mesh.faces)


@pytest.mark.parametrize(("surface", "triangles", "closed", "holes"), [
    (Plane(), 32, False, 1),
    (Sphere(), 1200, True, 2),
    (Sphere(layout="globe"), 1520, True, 2),
    (Tube(), 120, False, 0),
    (Teapot(), 2142, False, 1 + 1 + 0 + 0),
    (Vase(), 8640, False, 1),
    (Mushroom(), 2800, True, 2),
    (Planks(), 6, False, 3),
], ids=lambda value: getattr(value, "kind", None))
def test_the_built_in_surfaces_are_whole(surface: Any, triangles: int, closed: bool, holes: int) -> None:
    mesh = baked(surface)
    assert len(mesh.faces) == triangles
    assert is_watertight(mesh.vertices, mesh.faces) == closed
    assert euler(mesh) == holes
    assert len(flat_uv(mesh.corner_uv)) == 0
    assert mesh.notes == ()
    extent = np.ptp(mesh.vertices, axis=0)
    assert 0.5 < extent.max() <= 2.0


def test_a_finer_sphere_nears_its_volume() -> None:
    for layout in ("cube", "globe"):
        coarse, fine = (volume(baked(Sphere(layout=layout, radius=1, divisions=n))) for n in (8, 16))
        ball = 4 / 3 * math.pi
        assert fine == pytest.approx(ball, rel=0.01)
        assert (ball - coarse) / (ball - fine) == pytest.approx(4, rel=0.05)


def test_texture_repeats_as_often_as_asked() -> None:
    for kind in (Plane, Tube, Sphere):
        more = {"layout": "globe"} if kind is Sphere else {}
        uv = baked(kind(repeat_u=3, repeat_v=2, **more)).corner_uv
        np.testing.assert_allclose((uv.min(axis=(0, 1)), uv.max(axis=(0, 1))), ((0, 0), (3, 2)))
    a, b = np.moveaxis(np.diff(baked(Sphere()).corner_uv, axis=1), 1, 0)
    area = (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2
    assert area.sum() == pytest.approx(6), "each square of the cube has the whole texture"


def test_texture_is_no_mirror_image() -> None:
    """u to the right and v upwards, seen from the front: the front is where u turns to v counter-clockwise."""
    for surface in (Plane(), Sphere(), Sphere(layout="globe"), Tube(), Teapot(), Vase(), Mushroom(), Planks()):
        a, b = np.moveaxis(np.diff(baked(surface).corner_uv, axis=1), 1, 0)
        assert (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] > 0).all(), surface


def test_the_tube_is_a_cylinder() -> None:
    mesh = baked(Tube(radius=0.5, length=2, around=48, along=4))
    np.testing.assert_allclose(np.hypot(*mesh.vertices[:, :2].T), 0.5)
    np.testing.assert_allclose(np.unique(np.round(mesh.vertices[:, 2], 9)), (-1, -0.5, 0, 0.5, 1))
    normal = vertex_normals(mesh.vertices, mesh.faces)
    np.testing.assert_allclose(np.einsum("vk,vk->v", normal[:, :2], mesh.vertices[:, :2]) / 0.5, 1, atol=0.01)


def test_normals_do_not_depend_on_how_a_square_is_cut() -> None:
    """Three sides of a cube meet: by angles the normal is the diagonal, however many triangles each side has there."""
    x = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (0, 1, 1), (1, 0, 1)], float)
    faces = np.array([(0, 2, 4), (0, 4, 1), (0, 1, 6), (0, 6, 3), (0, 3, 2), (2, 3, 5)])
    np.testing.assert_allclose(vertex_normals(x, faces)[0], np.full(3, -1 / math.sqrt(3)), atol=1e-12)
    by_area = face_vectors(x, faces)[:5].sum(axis=0)
    assert abs(by_area / np.linalg.norm(by_area) + 1 / math.sqrt(3)).max() > 0.1, "areas would lean it"


def test_corners_at_one_place_become_one_vertex() -> None:
    one, other = [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(1, 0, 1e-9), (1, 1, 0), (-0.0, 1, 0)]
    corners = np.array([one, other, [(2, 2, 2), (2, 2, 2), (0, 0, 0)]])
    uv = np.arange(18.0).reshape(3, 3, 2)
    apart = from_corners(corners, uv)
    assert len(apart.vertices) == 5
    assert "1 faces" in apart.notes[0]
    joined = from_corners(corners, uv, tolerance=1e-6)
    np.testing.assert_array_equal(joined.faces, ((0, 1, 2), (1, 3, 2)))
    np.testing.assert_array_equal(joined.corner_uv, uv[:2])


@pytest.mark.parametrize("rows", [BODY, LID, HANDLE, SPOUT], ids=["body", "lid", "handle", "spout"])
def test_the_teapots_patches_join_smoothly(rows: np.ndarray) -> None:
    """At every joint the control points before and after it lie on one line through it: a slip in the published table
    would break that."""
    for joint in range(3, len(rows) - 1, 3):
        before, after = rows[joint] - rows[joint - 1], rows[joint + 1] - rows[joint]
        pairs = ((0, 2), (1, 2)) if rows is BODY or rows is LID else ((0, 1), (2, 3), (4, 4))
        for pair in pairs:
            assert abs(before[list(pair)] @ (after[list(pair)][::-1] * (1, -1))) < 1e-12


def test_the_teapots_quarters_are_round() -> None:
    """Newell's inner control points stand at 0.56 of the radius, where 0.5523 would fit a circle best."""
    rows = np.concatenate([BODY, LID])
    rows = rows[rows[:, 0] > 0]
    np.testing.assert_allclose(rows[:, 1] / rows[:, 0], 0.56, atol=0.003)


def test_the_teapot_is_its_own_mirror_image() -> None:
    mesh = baked(Teapot())
    key = np.round(mesh.vertices, 9) + 0.0
    np.testing.assert_array_equal(np.unique(key, axis=0), np.unique(np.round(key * (1, -1, 1), 9) + 0.0, axis=0))
    np.testing.assert_allclose(np.ptp(mesh.vertices[:, 0]), 1.6)
    assert len(baked(Teapot(detail=2)).faces) == 4 * 2142 + 2 * (28 + 26)


def test_every_part_of_the_teapot_has_its_front_outside() -> None:
    """Where a part is widest its normals look away from its middle."""
    mesh = baked(Teapot())
    normal, middle = face_vectors(mesh.vertices, mesh.faces), mesh.vertices[mesh.faces].mean(axis=1)
    for part in (middle[:, 0] < -0.55, middle[:, 0] > 0.6, abs(middle[:, 0]) < 0.3):
        side = middle[part] - middle[part].mean(axis=0)
        assert np.einsum("fk,fk->", normal[part], side) > 0


def unordered(surface: Planks) -> int:
    """How many cells of its shell are in, or behind, a cycle of cells that hide each other seen from above, along
    3,600 upright lines."""
    mesh = surface.mesh()
    shell = build_shell(mesh, 0.05 * vertex_normals(mesh.vertices, mesh.faces))
    x, y = np.meshgrid(*2 * [np.linspace(-0.8, 0.8, 60)])
    normal, rest = shell.planes[..., :3], shell.planes[..., 3]
    level = normal[..., 0, None] * x.ravel() + normal[..., 1, None] * y.ravel() + rest[..., None]
    with np.errstate(divide="ignore", invalid="ignore"):
        meets = -level / normal[..., 2, None]
    floor = np.where(normal[..., 2, None] < 0, meets, -np.inf).max(axis=1)
    roof = np.where(normal[..., 2, None] > 0, meets, np.inf).min(axis=1)
    held = (floor < roof - 1e-6) & ~((normal[..., 2, None] == 0) & (level > 0)).any(axis=1)
    middle = np.where(held, (floor + roof) / 2, np.nan)
    hides = (middle[:, None] > middle[None]).any(axis=-1)
    left = np.ones(len(hides), bool)
    while (free := left & ~hides[left].any(axis=0)).any():
        left &= ~free
    return int(left.sum())


def test_planks_hide_each_other_in_a_circle() -> None:
    assert unordered(Planks()) == 18
    assert unordered(Planks(along=2)) == 0


class TestUserMesh:
    """An uploaded mesh: its own texture coordinates, or those of a simple body."""

    def stored(self, mesh: trimesh.Trimesh, kind: str = "obj") -> str:
        data = trimesh.exchange.export.export_mesh(mesh, None, file_type=kind)
        return "asset:" + AssetStore().put(data.encode() if isinstance(data, str) else data, "mesh", f"mesh.{kind}")

    def test_it_is_centred_and_scaled(self) -> None:
        mesh = baked(UserMesh(asset=self.stored(trimesh.creation.box((2, 4, 8))), size=2))
        np.testing.assert_allclose(mesh.vertices.min(axis=0), (-0.25, -0.5, -1))
        np.testing.assert_allclose(mesh.vertices.max(axis=0), (0.25, 0.5, 1))
        assert len(mesh.vertices) == 8
        assert is_watertight(mesh.vertices, mesh.faces)
        assert "of a box" in mesh.notes[-1]

    def test_its_own_coordinates_are_kept(self) -> None:
        body = trimesh.creation.box((1, 1, 1))
        uv = np.random.default_rng(3).random((8, 2))
        body.visual = trimesh.visual.TextureVisuals(uv=uv)
        mesh = baked(UserMesh(asset=self.stored(body), size=0, repeat_u=2, repeat_v=3))
        for face, own in zip(mesh.faces, mesh.corner_uv):
            for vertex, at in zip(face, own):
                index = np.abs(body.vertices - mesh.vertices[vertex]).sum(axis=1).argmin()
                np.testing.assert_allclose(at, uv[index] * (2, 3), atol=1e-6)

    @pytest.mark.parametrize("mapping", ["box", "cylinder", "sphere", "plane"])
    def test_a_mapping_covers_every_face(self, mapping: Any) -> None:
        ball = Sphere(divisions=6).mesh()
        uv = mapped(ball.vertices[ball.faces], mapping)
        assert np.isfinite(uv).all()
        assert np.ptp(uv, axis=1).max() < 0.4, "no face spans the seam"
        a, b = np.moveaxis(np.diff(uv, axis=1), 1, 0)
        area = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
        if mapping in ("box", "sphere"):
            assert (area > 0).all()
        assert len(flat_uv(uv)) == 0

    def test_what_cannot_be_used_is_named(self, monkeypatch: pytest.MonkeyPatch) -> None:
        with pytest.raises(AssetError, match="expired") as caught:
            baked(UserMesh(asset="asset:" + "0" * 64))
        assert caught.value.field == "surface.asset"
        monkeypatch.setattr(surface_mapping, "MAX_TRIANGLES", 11)
        with pytest.raises(LimitError, match="12 triangles") as refused:
            baked(UserMesh(asset=self.stored(trimesh.creation.box((1, 1, 1)))))
        assert refused.value.field == "surface.asset"
