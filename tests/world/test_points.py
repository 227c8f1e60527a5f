"""Clouds of points as files have them, and the normals of those that have none."""

from __future__ import annotations

import struct
from pathlib import Path

import laspy
import numpy as np
import pytest

from renderer.core.errors import AssetError, InputError, LimitError
from renderer.world.image import srgb_decode
from renderer.world.limits import Limits
from renderer.world.points import PointsReading, load_points
from renderer.world.points_normals import estimated_normals
from renderer.world.upload import check_in_worker, recognise

RNG = np.random.default_rng(7)
COUNT = 40
PLACE = RNG.normal(size=(COUNT, 3)).astype(np.float32)
NORMAL = PLACE / np.linalg.norm(PLACE, axis=1, keepdims=True)
COLOUR = RNG.integers(0, 256, (COUNT, 3)).astype(np.uint8)


def ply(said: str, faces: int = 0) -> bytes:
    """The cloud as PLY, with a property that nobody reads in the middle."""
    head = f"ply\nformat {said} 1.0\ncomment made here\nelement vertex {COUNT}\nproperty float x\nproperty float y\n"
    head += "property float z\nproperty int label\nproperty float nx\nproperty float ny\nproperty float nz\n"
    head += "property uchar red\nproperty uchar green\nproperty uchar blue\n"
    head += f"element face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
    body = b""
    for p, n, c in zip(PLACE, NORMAL, COLOUR):
        if said == "ascii":
            body += " ".join([*map(repr, p.tolist()), "7", *map(repr, n.tolist()), *map(str, c.tolist())]).encode()
            body += b"\n"
        else:
            body += struct.pack(("<" if "little" in said else ">") + "3fi3f3B", *p, 7, *n, *c)
    return head.encode() + body + (b"3 0 1 2\n" if said == "ascii" else b"") * faces


def saved(tmp_path: Path, name: str, kind: str) -> Path:
    path = tmp_path / name
    if kind in ("ascii", "binary_little_endian", "binary_big_endian"):
        path.write_bytes(ply(kind))
    elif kind == "npz":
        np.savez(path, position=PLACE, normal=NORMAL, colour=COLOUR)
    elif kind == "npy":
        np.save(path, np.concatenate([PLACE, NORMAL, srgb_decode(COLOUR / 255)], axis=1))
    else:
        header = laspy.LasHeader(point_format=2, version="1.2")
        header.scales = np.full(3, 1e-6)
        table = laspy.LasData(header)
        table.x, table.y, table.z = PLACE.T.astype(np.float64)
        table.red, table.green, table.blue = COLOUR.T.astype(np.uint16) * 257
        table.write(path)
    return path


@pytest.mark.parametrize(
    ("name", "kind"),
    [("a.ply", "ascii"), ("b.ply", "binary_little_endian"), ("c.ply", "binary_big_endian"), ("d.npz", "npz"),
     ("e.npy", "npy"), ("f.las", "las"), ("g.laz", "laz")],
)
def test_every_format_says_the_same(tmp_path: Path, name: str, kind: str) -> None:
    path = saved(tmp_path, name, kind)
    assert recognise(path) == "points"
    found = load_points(path)
    assert found.position == pytest.approx(PLACE, abs=1e-6)
    assert found.colour == pytest.approx(srgb_decode(COLOUR / 255), abs=1e-6)
    if name[0] < "f":
        assert found.normal == pytest.approx(NORMAL, abs=1e-6)
    else:
        assert found.normal is None


def test_the_check_of_an_upload_tells_what_it_holds(tmp_path: Path) -> None:
    told = check_in_worker(saved(tmp_path, "a.ply", "ascii"), "points", reading={"unit_length": 0.5})
    assert told["points"] == COUNT
    assert told["normals"] is True
    assert told["extent"] == pytest.approx((np.ptp(PLACE, axis=0) * 0.5).tolist())
    laz = check_in_worker(saved(tmp_path, "g.laz", "laz"), "points")
    assert laz["colours"] is True


def test_axes_turn_with_their_normals(tmp_path: Path) -> None:
    found = load_points(saved(tmp_path, "d.npz", "npz"), reading=PointsReading(up="y", unit_length=2.0))
    assert found.position == pytest.approx(2 * np.stack([PLACE[:, 0], -PLACE[:, 2], PLACE[:, 1]], axis=1))
    assert found.normal == pytest.approx(np.stack([NORMAL[:, 0], -NORMAL[:, 2], NORMAL[:, 1]], axis=1), abs=1e-6)


def test_a_ply_with_faces_is_a_mesh_whose_points_can_be_had(tmp_path: Path) -> None:
    path = tmp_path / "mesh.ply"
    path.write_bytes(ply("ascii", faces=1))
    assert recognise(path) == "mesh"
    assert "faces were left out" in " ".join(load_points(path).notes)


@pytest.mark.parametrize(
    ("arrays", "field"),
    [
        ({"position": np.full((20, 3), np.nan)}, "position"),
        ({"position": np.zeros((20, 3))}, "position"),
        ({"position": PLACE[:5]}, "position"),
        ({"position": PLACE[:, :2]}, "position"),
        ({"position": PLACE, "normal": NORMAL[:7]}, "normal"),
        ({"position": PLACE, "colour": COLOUR / 100}, "colour"),
        ({"position": PLACE, "colour": COLOUR[:, :2]}, "colour"),
        ({"position": np.array([["a"] * 3] * 20)}, "position"),
    ],
)
def test_what_is_no_cloud_is_refused_by_name(tmp_path: Path, arrays: dict[str, np.ndarray], field: str) -> None:
    np.savez(tmp_path / "x.npz", **arrays)
    with pytest.raises(AssetError) as caught:
        load_points(tmp_path / "x.npz")
    assert caught.value.field == field


@pytest.mark.parametrize("kind", ["ascii", "binary_little_endian", "las", "laz", "npy", "npz"])
def test_damaged_files_are_refused_in_words(tmp_path: Path, kind: str) -> None:
    ending = kind if kind[0] in "ln" else "ply"
    whole = saved(tmp_path, f"x.{ending}", kind).read_bytes()
    for cut in (len(whole) // 2, len(whole) - 60):
        path = tmp_path / f"cut.{ending}"
        path.write_bytes(whole[:cut])
        with pytest.raises(InputError):
            load_points(path)


def test_too_many_points_are_refused_before_they_are_read(tmp_path: Path) -> None:
    for name, kind in (("a.ply", "ascii"), ("b.ply", "binary_big_endian"), ("d.npz", "npz"), ("f.las", "las")):
        with pytest.raises(LimitError):
            load_points(saved(tmp_path, name, kind), Limits(points=16))


def test_a_list_among_the_points_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "x.ply"
    path.write_bytes(ply("ascii").replace(b"property int label", b"property list uchar int label"))
    with pytest.raises(AssetError, match="not one number"):
        load_points(path)


def test_normals_of_a_torus_look_outwards() -> None:
    u, v = np.random.default_rng(3).uniform(0, 2 * np.pi, (2, 6000))
    outwards = np.stack([np.cos(u) * np.cos(v), np.sin(u) * np.cos(v), np.sin(v)], axis=1)
    place = np.stack([np.cos(u), np.sin(u), 0 * u], axis=1) + 0.45 * outwards
    other = place * 0.3 + [0, 0, 4]
    normal, away = estimated_normals(np.concatenate([place, other]), lambda share, words: None)
    cosine = (normal * np.concatenate([outwards, outwards])).sum(axis=1)
    assert np.linalg.norm(normal, axis=1) == pytest.approx(1.0)
    assert (cosine > 0.9).mean() > 0.98
    assert (cosine > 0).mean() > 0.999
    assert np.median(away[:6000]) == pytest.approx(np.median(away[6000:]) / 0.3, rel=0.02)
