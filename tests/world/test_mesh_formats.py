"""Broken meshes: false headers, cuts, noise and emptiness are named and never half a mesh."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from renderer.core.errors import AssetError, LimitError
from renderer.world.limits import Limits
from renderer.world.mesh import load_mesh
from renderer.world.mesh_formats import mesh_format
from tests.world.meshes import box, quad_glb, written

FORMATS = ("glb", "obj", "ply", "stl", "off")


@pytest.mark.parametrize(
    ("name", "text", "field"),
    [
        ("no_faces.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\n", "faces"),
        ("no_faces.off", b"OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", "faces"),
        ("no_faces.stl", b"solid nothing\nendsolid nothing\n", "faces"),
        (
            "no_faces.ply",
            b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
            b"element face 0\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n",
            "faces",
        ),
        ("binary.stl", b"\0" * 84, "faces"),
        ("flat.obj", b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "faces"),
        ("nan.obj", b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", ""),
        ("nan.off", b"OFF\n3 1 0\nnan 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "vertices"),
        ("inf.off", b"OFF\n3 1 0\ninf 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "vertices"),
        ("far.off", b"OFF\n3 1 0\n1e30 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "vertices"),
        ("index.off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", "file"),
        ("index.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "file"),
        ("short.off", b"OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "faces"),
        ("text.obj", b"hello, I am a letter\n", "file"),
        ("empty.obj", b"", "file"),
        ("old.glb", struct.pack("<4sIIII", b"glTF", 1, 20, 0, 0x4E4F534A), "file"),
    ],
)
def test_what_is_no_mesh_is_refused_by_its_field(name: str, text: bytes, field: str, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_bytes(text)
    with pytest.raises(AssetError) as refusal:
        load_mesh(path)
    assert field in ("", refusal.value.field)


def test_headers_that_claim_too_much_are_refused_before_anything_is_held(tmp_path: Path) -> None:
    cases = {
        "vast.ply": b"ply\nformat binary_little_endian 1.0\nelement vertex 178956970\nproperty float x\n"
        b"property float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n",
        "vast.off": b"OFF\n178956970 1 0\n",
    }
    for name, data in cases.items():
        (tmp_path / name).write_bytes(data)
        with pytest.raises(LimitError, match=r"vertices.*178,956,970"):
            load_mesh(tmp_path / name)

    def vast(document: dict) -> None:
        document["accessors"].append({"componentType": 5126, "count": 178_956_970, "type": "VEC3"})

    with pytest.raises(LimitError, match="vertices"):
        load_mesh(quad_glb(tmp_path, edit=vast))
    with pytest.raises(AssetError, match="KHR_draco_mesh_compression"):
        load_mesh(quad_glb(tmp_path, edit=lambda d: d.update(extensionsRequired=["KHR_draco_mesh_compression"])))


def test_a_vast_texture_is_refused_before_it_is_decoded(tmp_path: Path) -> None:
    with pytest.raises(LimitError, match=r"texture.*3,000 x 3,000"):
        load_mesh(quad_glb(tmp_path, picture=Image.new("1", (3000, 3000))), Limits(texture_pixels=1_000_000))


@pytest.mark.parametrize("kind", FORMATS)
def test_a_truncated_mesh_is_refused_and_never_half_a_mesh(kind: str, tmp_path: Path) -> None:
    """OBJ has no counts and no end: a cut there may leave a smaller valid mesh, so it need only not break."""
    data = written(box(), kind, tmp_path).read_bytes()
    path = tmp_path / f"cut.{kind}"
    for tenth in range(10):
        path.write_bytes(data[: len(data) * tenth // 10])
        if kind == "obj":
            try:
                assert len(load_mesh(path).faces) <= 12
            except AssetError:
                continue
        else:
            with pytest.raises(AssetError):
                load_mesh(path)


def test_random_bytes_behind_every_mark_give_words(tmp_path: Path) -> None:
    rng = np.random.Generator(np.random.PCG64(200))
    for mark in (b"", b"glTF", b"ply\n", b"OFF ", b"solid facet", b'{"asset":{"version":"2.0"}', b"v 0 0 0\nf "):
        for _ in range(6):
            path = tmp_path / "noise.stl"
            path.write_bytes(mark + rng.bytes(200))
            with pytest.raises(AssetError):
                load_mesh(path)


@pytest.mark.timeout(20)
def test_blank_lines_and_endless_comments_cost_no_more_than_their_length(tmp_path: Path) -> None:
    """Patterns that backtrack over these took minutes, in the server's own process."""
    assert mesh_format(b"\n" * 60_000 + b"x") is None
    assert mesh_format(b" " * 60_000 + b"x") is None
    for data in (
        b"OFF " + b"# " * 30_000 + b"x",
        b"OFF" + b"\n" * 60_000,
        b"ply\nend_header\n" + b"element a 1\n\n\n" * 4_000,
    ):
        path = tmp_path / "slow"
        path.write_bytes(data)
        with pytest.raises(AssetError):
            load_mesh(path)
