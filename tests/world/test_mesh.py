"""Meshes: all formats give the same metres and colours, nothing else is opened, and what is broken is named."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

from renderer.core.errors import AssetError, LimitError
from renderer.world.image import srgb_decode
from renderer.world.limits import Limits
from renderer.world.mesh import DEFAULT_COLOUR, Mesh, MeshReading, is_watertight, load_mesh
from tests.world.meshes import box, quad_glb, written

FORMATS = ("glb", "obj", "ply", "stl", "off")


@pytest.mark.parametrize("kind", FORMATS)
def test_every_format_gives_the_same_box(kind: str, tmp_path: Path) -> None:
    mesh = load_mesh(written(box(), kind, tmp_path), reading=MeshReading(up="z"))
    low, high = mesh.bounds
    np.testing.assert_allclose(low, (10, 20, 30), atol=1e-6)
    np.testing.assert_allclose(high, (11, 22, 33), atol=1e-6)
    assert mesh.faces.shape == (12, 3)
    assert mesh.watertight
    assert not mesh.two_sided
    outward = np.einsum("fk,fk->f", mesh.face_normals(), mesh.vertices[mesh.faces].mean(axis=1) - (10.5, 21, 31.5))
    assert outward.min() > 0


def test_gltf_is_y_up_and_others_z_up(tmp_path: Path) -> None:
    low, high = load_mesh(quad_glb(tmp_path)).bounds
    np.testing.assert_allclose((low, high), ((0, 0, 0), (1, 0, 1)), atol=1e-7)
    np.testing.assert_allclose(load_mesh(written(box(), "obj", tmp_path)).bounds[1], (11, 22, 33), atol=1e-6)
    turned = load_mesh(written(box(), "obj", tmp_path), reading=MeshReading(up="y", unit_length=0.5))
    np.testing.assert_allclose(turned.bounds[1], (5.5, -15, 11), atol=1e-6)
    assert (
        np.einsum("fk,fk->f", turned.face_normals(), turned.vertices[turned.faces].mean(axis=1) - (5.25, -15.75, 10.5))
        > 0
    ).all()


def test_painted_vertices_and_faces_become_linear_face_colours(tmp_path: Path) -> None:
    painted = box()
    painted.visual.vertex_colors = np.tile(np.array([188, 0, 255, 255], dtype=np.uint8), (8, 1))
    mesh = load_mesh(written(painted, "ply", tmp_path))
    np.testing.assert_allclose(mesh.face_colour, np.tile(srgb_decode(np.array([188, 0, 255]) / 255), (12, 1)))
    painted = box()
    painted.visual.face_colors = np.array([[20 * k, 0, 0, 255] for k in range(12)], dtype=np.uint8)
    mesh = load_mesh(written(painted, "ply", tmp_path))
    np.testing.assert_allclose(mesh.face_colour[:, 0], srgb_decode(20 * np.arange(12) / 255))


def test_a_mesh_without_colours_is_grey(tmp_path: Path) -> None:
    np.testing.assert_array_equal(
        load_mesh(written(box(), "off", tmp_path)).face_colour, np.tile(DEFAULT_COLOUR, (12, 1))
    )


def test_gltf_factors_are_linear_and_exact(tmp_path: Path) -> None:
    """A spruce needle's 0.035 must not be rounded to 8 bits (0.0353), nor passed through the sRGB curve (0.0027)."""
    mesh = load_mesh(quad_glb(tmp_path, base=(0.03, 0.07, 0.035, 1)))
    np.testing.assert_allclose(mesh.face_colour, np.tile((0.03, 0.07, 0.035), (2, 1)), rtol=1e-12)
    assert mesh.two_sided  # open


def test_a_texture_is_averaged_in_linear_light_under_each_face(tmp_path: Path) -> None:
    """Left half black, right half white, faces split along the diagonal: shares 3/4 and 1/4 of white."""
    picture = Image.new("RGB", (256, 256))
    picture.paste((255, 255, 255), (128, 0, 256, 256))
    mesh = load_mesh(quad_glb(tmp_path, base=(1, 0.5, 0, 1), picture=picture))
    # 16 samples a face resolve a share to 1/16. Black and white hide the curve, so the last lines use a grey.
    np.testing.assert_allclose(mesh.face_colour[:, 0], (0.75, 0.25), atol=1 / 16)
    np.testing.assert_allclose(mesh.face_colour[:, 1], 0.5 * mesh.face_colour[:, 0])
    assert (mesh.face_colour[:, 2] == 0).all()
    grey = load_mesh(quad_glb(tmp_path, picture=Image.new("RGB", (4, 4), (188, 188, 188))))
    np.testing.assert_allclose(grey.face_colour, srgb_decode(np.array([188 / 255]))[0], rtol=1e-5)


def test_texture_rows_run_from_the_top(tmp_path: Path) -> None:
    """The first face is the lower right half of the quad; a flipped v would give it the upper row's colour."""
    picture = Image.new("RGB", (2, 2), (255, 0, 0))
    picture.paste((0, 255, 0), (0, 1, 2, 2))
    mesh = load_mesh(quad_glb(tmp_path, picture=picture.resize((64, 64), Image.Resampling.NEAREST)))
    assert mesh.face_colour[0, 1] == pytest.approx(0.75, abs=0.1)
    assert mesh.face_colour[1, 0] == pytest.approx(0.75, abs=0.1)


def test_a_transparent_texture_is_said(tmp_path: Path) -> None:
    mesh = load_mesh(quad_glb(tmp_path, picture=Image.new("RGBA", (4, 4), (255, 255, 255, 0))))
    assert any("transparency" in note for note in mesh.notes)


def test_flat_texture_coordinates_are_said_and_broken_ones_refused(tmp_path: Path) -> None:
    broken = quad_glb(tmp_path, picture=Image.new("RGB", (4, 4)))
    data = broken.read_bytes()
    good = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], dtype="<f4").tobytes()
    broken.write_bytes(data.replace(good, np.full(8, np.nan, dtype="<f4").tobytes()))
    with pytest.raises(AssetError) as refusal:
        load_mesh(broken)
    assert refusal.value.field == "uv"
    broken.write_bytes(data.replace(good, np.zeros(8, dtype="<f4").tobytes()))
    assert any("2 faces have texture coordinates without area" in note for note in load_mesh(broken).notes)


def test_instances_are_placed_and_mirrored_ones_keep_their_outside(tmp_path: Path) -> None:
    scene = trimesh.Scene()
    unit = trimesh.creation.box(extents=(1, 1, 1))
    scene.add_geometry(unit, node_name="a", geom_name="g")
    mirror = np.diag([-1.0, 1, 1, 1])
    mirror[0, 3] = 5
    scene.graph.update(frame_to="b", matrix=mirror, geometry="g")
    mesh = load_mesh(written(scene, "glb", tmp_path), reading=MeshReading(up="z"))
    assert len(mesh.faces) == 24
    np.testing.assert_allclose(mesh.bounds, ((-0.5, -0.5, -0.5), (5.5, 0.5, 0.5)), atol=1e-6)
    centres = np.where(mesh.vertices[mesh.faces].mean(axis=1)[:, :1] > 2.5, (5.0, 0, 0), (0.0, 0, 0))
    assert np.einsum("fk,fk->f", mesh.face_normals(), mesh.vertices[mesh.faces].mean(axis=1) - centres).min() > 0
    assert mesh.watertight


def test_instances_count_against_the_limit(tmp_path: Path) -> None:
    def crowd(document: dict) -> None:
        document["nodes"] = [{"mesh": 0} for _ in range(600)]
        document["scenes"][0]["nodes"] = list(range(600))

    with pytest.raises(LimitError, match=r"faces.*1,200"):
        load_mesh(quad_glb(tmp_path, edit=crowd), Limits(faces=1000))


def test_nothing_outside_the_file_is_opened(tmp_path: Path) -> None:
    """The neighbours exist and would change the colours, were they read."""
    (tmp_path / "red.mtl").write_text("newmtl red\nKd 1 0 0\n")
    obj = tmp_path / "box.obj"
    obj.write_text("mtllib red.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n")
    mesh = load_mesh(obj)
    np.testing.assert_array_equal(mesh.face_colour, [DEFAULT_COLOUR])
    assert mesh.notes == ("red.mtl is another file and was not read",)
    Image.new("RGB", (2, 2), (255, 0, 0)).save(tmp_path / "red.png")
    textured = load_mesh(quad_glb(tmp_path, image_uri="red.png"))
    np.testing.assert_allclose(textured.face_colour, 1)
    assert any("red.png is another file" in note for note in textured.notes)
    with pytest.raises(AssetError, match="file: keeps its geometry in another file"):
        load_mesh(quad_glb(tmp_path, edit=lambda d: d["buffers"][0].update(uri="../../etc/passwd")))


def test_vertex_normals_come_from_the_file_or_not_at_all(tmp_path: Path) -> None:
    assert load_mesh(written(box(), "off", tmp_path)).vertex_normals is None
    ball = trimesh.creation.icosphere(subdivisions=2)
    path = tmp_path / "ball.ply"
    path.write_bytes(trimesh.exchange.ply.export_ply(ball, vertex_normal=True))
    normals = load_mesh(path, reading=MeshReading(unit_length=3.0)).vertex_normals
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1)
    np.testing.assert_allclose(normals, load_mesh(path).vertices, atol=0.05)


def test_watertight_needs_agreement_on_the_outside() -> None:
    solid = box()
    assert is_watertight(solid.vertices, solid.faces)
    assert not is_watertight(solid.vertices, solid.faces[1:])
    flipped = solid.faces.copy()
    flipped[0] = flipped[0, ::-1]
    assert not is_watertight(solid.vertices, flipped)
    soup = solid.vertices[solid.faces].reshape(-1, 3)
    assert is_watertight(soup, np.arange(len(soup)).reshape(-1, 3))


def test_texture_coordinates_stay_with_their_corners(tmp_path: Path) -> None:
    """A vertex on a seam has one place and several texture coordinates: each face keeps its own."""
    text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 5 5\nf 1/1 2/2 3/3\nf 1/5 3/3 4/4\n"
    path = tmp_path / "seam.obj"
    path.write_text(text)
    mesh = load_mesh(path)
    assert mesh.corner_uv is not None
    at = {tuple(place): tuple(uv) for place, uv in zip(mesh.vertices[mesh.faces[0]], mesh.corner_uv[0])}
    assert at == {(0, 0, 0): (0, 0), (1, 0, 0): (1, 0), (1, 1, 0): (1, 1)}
    at = {tuple(place): tuple(uv) for place, uv in zip(mesh.vertices[mesh.faces[1]], mesh.corner_uv[1])}
    assert at == {(0, 0, 0): (5, 5), (1, 1, 0): (1, 1), (0, 1, 0): (0, 1)}


@pytest.mark.parametrize("names", [("s", "t"), ("u", "v"), ("texture_u", "texture_v")])
def test_a_ply_file_has_texture_coordinates_by_any_of_their_names(names: tuple[str, str], tmp_path: Path) -> None:
    header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    header += f"property float {names[0]}\nproperty float {names[1]}\n"
    header += "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    path = tmp_path / "mesh.ply"
    path.write_text(header + "0 0 0 0.1 0.2\n1 0 0 0.3 0.4\n0 1 0 0.5 0.6\n3 0 1 2\n")
    np.testing.assert_allclose(load_mesh(path).corner_uv, [[(0.1, 0.2), (0.3, 0.4), (0.5, 0.6)]], atol=1e-7)


def test_gltf_texture_coordinates_run_upwards_and_follow_a_mirror(tmp_path: Path) -> None:
    """glTF counts v downwards. An instance mirrored by its transform has its corners in reverse, and their uv too."""
    def check(mesh: Mesh) -> None:
        assert mesh.corner_uv is not None
        x = np.abs(mesh.vertices[mesh.faces])
        np.testing.assert_allclose(mesh.corner_uv, x[..., [0, 2]], atol=1e-6)

    check(load_mesh(quad_glb(tmp_path)))
    mirrored = load_mesh(quad_glb(tmp_path, edit=lambda document: document["nodes"][0].update(scale=[-1, 1, 1])))
    assert mirrored.bounds[0][0] == -1
    check(mirrored)


def test_a_file_without_texture_coordinates_says_nothing_of_them(tmp_path: Path) -> None:
    assert load_mesh(written(box(), "stl", tmp_path)).corner_uv is None
