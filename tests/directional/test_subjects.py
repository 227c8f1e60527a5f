"""Built-in subjects: closed or two-sided, standing at the origin, coloured like matter; and any mesh."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import pytest
import trimesh

from renderer.core.cache import AssetStore
from renderer.core.errors import InputError
from renderer.directional.casting import Caster
from renderer.directional.cloud import bake_cloud
from renderer.directional.shadow_hemispheres import bake_shadows
from renderer.directional.subject import basket, dragon, knot, relief, rock, teapot
from renderer.directional.subject.solid import FINEST, FLATTEST, Solid, compact
from renderer.directional.subject.surface_nets import surface_nets
from renderer.directional.subject.tree import Tree
from renderer.directional.subjects import MARGIN, bake_subject
from renderer.world.mesh_normals import corner_normals, face_vectors

BUILT_IN = ("dragon", "teapot", "basket", "knot", "rock", "tree", "relief")


SMALL = {"basket": {"rows": 8, "stakes": 14}, "tree": {"species": "birch"}}
"""Parameters that make a subject quick to make."""


def silent(share: float, words: str) -> None:
    pass


def baked(document: dict[str, Any]) -> dict[str, np.ndarray]:
    return dict(bake_subject(document, {}, silent))


@pytest.mark.parametrize("kind", BUILT_IN)
def test_built_in_subjects_are_sound(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dragon, "CELL", 0.025)
    monkeypatch.setattr(rock, "HALVINGS", 4)
    monkeypatch.setattr(relief, "NODES", 64)
    monkeypatch.setattr(knot, "ALONG", 700)
    monkeypatch.setattr(teapot, "FINER", dict.fromkeys(teapot.FINER, 3))
    monkeypatch.setattr(basket, "SIDES", 6)
    made = baked({"kind": kind, "size": 3.0, **SMALL.get(kind, {})})
    low, high = made["vertices"].min(axis=0), made["vertices"].max(axis=0)
    assert (high - low).max() == pytest.approx(3.0)
    assert low[2] == pytest.approx(0.0, abs=1e-9)
    assert np.abs((low + high)[:2]).max() < 1e-9
    margin = MARGIN * np.linalg.norm(high - low)
    assert made["box"] == pytest.approx(np.stack([low - margin, high + margin]))
    assert 5_000 < len(made["faces"]) < 400_000
    assert made["colour"].min() >= 0
    assert made["colour"].max() < 0.8  # no matter on land is whiter, but snow
    assert made["colour"].std(axis=0).max() > 0.02
    vectors = face_vectors(made["vertices"], made["faces"])
    area = np.linalg.norm(vectors, axis=1, keepdims=True)
    assert (area > 0).all()
    assert np.linalg.norm(made["normals"], axis=-1) == pytest.approx(1.0)
    facing = (made["normals"] * (vectors / area)[:, None]).sum(axis=-1)
    assert facing.min() > 0  # no corner looks behind its own face
    if not made["two_sided"]:
        # Outwards: the divergence theorem gives a volume, and a positive one.
        volume = np.einsum("fk,fk->", made["vertices"][made["faces"][:, 0]], vectors) / 6
        assert 0.01 < volume / np.prod(high - low) < 0.9


def test_the_seed_decides() -> None:
    first, again, other = (Tree(species="birch", seed=seed).solid().vertices for seed in (1, 1, 2))
    assert (first == again).all()
    assert first.shape != other.shape or not (first == other).all()


def test_loops_with_a_common_divisor_are_several_ropes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(knot, "ALONG", 300)
    for turns, loops, count in ((2, 3, 1), (2, 4, 2), (3, 6, 3)):
        made = knot.Knot(turns=turns, loops=loops).solid()
        pieces = trimesh.Trimesh(made.vertices, made.faces, process=False)
        assert pieces.is_watertight
        assert pieces.body_count == count


def test_the_net_of_a_ball_is_closed_and_round() -> None:
    cell = 0.05
    vertices, faces = surface_nets(
        lambda place: np.linalg.norm(place, axis=-1) - 0.7, np.full(3, -1.0), np.full(3, 1.0), cell
    )
    ball = trimesh.Trimesh(vertices, faces, process=False)
    assert ball.is_watertight
    assert ball.is_winding_consistent
    # Means of chords lie inside by at most the sagitta of a cell's diagonal.
    off = np.linalg.norm(vertices, axis=1) - 0.7
    assert off.max() < 1e-6
    assert off.min() > -3 * cell**2 / 8 / 0.7 * 1.5
    assert ball.volume == pytest.approx(4 / 3 * np.pi * 0.7**3, rel=0.01)


def test_long_thin_triangles_are_cut_and_nothing_else() -> None:
    vertices = np.array([(0, 0, 0), (10, 0, 0), (10, 0.5, 0), (0, 0.5, 0), (0, 10, 0), (10, 10, 0)], float)
    faces = np.array([(0, 1, 2), (0, 2, 3), (3, 2, 5), (3, 5, 4), (1, 1, 2)])
    colour = np.arange(15).reshape(5, 3) / 15
    made = compact(Solid(vertices, faces, colour))
    area = np.linalg.norm(face_vectors(made.vertices, made.faces), axis=1) / 2
    assert area.sum() == pytest.approx(100.0)
    for k in range(4):
        own = (made.colour == colour[k]).all(axis=1)
        assert area[own].sum() == pytest.approx([2.5, 2.5, 47.5, 47.5][k])
        assert own.sum() == 1 or k < 2
    sides = np.linalg.norm(np.roll(made.vertices[made.faces], -1, axis=1) - made.vertices[made.faces], axis=2)
    longest = sides.max(axis=1)
    assert ((longest <= FLATTEST * 2 * area / longest + 1e-9) | (longest < 200**0.5 / FINEST)).all()
    assert made.shaded()[..., 2] == pytest.approx(1.0)


def test_an_edge_stays_an_edge_and_a_curve_stays_smooth() -> None:
    box = trimesh.creation.box()
    normals = corner_normals(np.asarray(box.vertices), np.asarray(box.faces))
    assert normals == pytest.approx(np.repeat(box.face_normals[:, None], 3, axis=1), abs=1e-12)
    ball = trimesh.creation.icosphere(subdivisions=3)
    normals = corner_normals(np.asarray(ball.vertices), np.asarray(ball.faces))
    assert normals == pytest.approx(ball.vertices[ball.faces], abs=0.01)


def put(body: bytes, kind: str, name: str) -> str:
    return f"asset:{AssetStore().put(body, kind, name)}"


def test_a_mesh_of_ones_own(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("UMBRAGE_CACHE", str(tmp_path))
    ball = trimesh.creation.icosphere(subdivisions=3, radius=7)
    half = trimesh.Trimesh(ball.vertices, ball.faces[ball.triangles_center[:, 2] > 0])
    for mesh, sides, two in ((ball, "file", False), (half, "file", True), (half, "one", False), (ball, "both", True)):
        body = io.BytesIO()
        mesh.export(body, file_type="ply")
        made = baked({"kind": "mesh", "asset": put(body.getvalue(), "mesh", "own.ply"), "sides": sides})
        assert bool(made["two_sided"]) is two
        assert np.ptp(made["vertices"], axis=0).max() == pytest.approx(2.0)
        assert made["vertices"][:, 2].min() == pytest.approx(0.0, abs=1e-9)


def test_a_file_that_is_not_there_is_named(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("UMBRAGE_CACHE", str(tmp_path))
    for kind in ("mesh", "relief"):
        with pytest.raises(InputError) as caught:
            baked({"kind": kind, "asset": "asset:" + "0" * 64})
        assert caught.value.field == "subject.asset"


def test_points_of_ones_own_are_squares_without_gaps(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("UMBRAGE_CACHE", str(tmp_path))
    turn = np.arange(4000) * (np.pi * (3 - np.sqrt(5)))
    height = 1 - (np.arange(4000) + 0.5) / 2000
    place = np.stack([np.sqrt(1 - height**2) * np.cos(turn), np.sqrt(1 - height**2) * np.sin(turn), height], axis=1)
    body = io.BytesIO()
    np.savez(body, position=place + [400_000, 5_000_000, 300], colour=np.abs(place))
    document = {"kind": "points", "asset": put(body.getvalue(), "points", "ball.npz"), "sides": "one"}
    made = baked(document)
    assert len(made["faces"]) == 8000
    assert (np.bincount(made["source"]) == 2).all()
    cloud = bake_cloud({"points": 1000}, {"subject": made}, silent)
    assert len(cloud["position"]) == 4000
    centre = made["box"].mean(axis=0)
    away = (cloud["position"] - centre) / np.linalg.norm(cloud["position"] - centre, axis=1, keepdims=True)
    assert (away * cloud["normal"]).sum(axis=1).min() > 0.98
    assert cloud["colour"] == pytest.approx(np.abs(away), abs=0.01)
    # Rays towards the ball meet a point near them, and never fall through.
    eyes = centre + away * [3, 3, 3]
    for k in range(0, 4000, 400):
        seen = Caster(made, cloud).points(np.repeat(eyes[k : k + 1], 1, axis=0), -away[k])
        assert np.linalg.norm(cloud["position"][seen[0]] - cloud["position"][k]) < 2 * float(cloud["spacing"])
    # A ball is in nobody's light: what rises over a point is its neighbours' squares, which the lift clears.
    seen = {"used": np.arange(0, 4000, 40, dtype=np.int32)}
    for lift, least, most in ((made["lift"], 0.99, 1.0), (np.asarray(0.0), 0.3, 0.98)):
        inputs = {"subject": {**made, "lift": lift}, "cloud": cloud, "visibility": seen}
        open_to = bake_shadows({"directions": 129}, inputs, silent)["openness"].mean()
        assert least < open_to <= most + 1e-6
    with pytest.raises(InputError, match="size"):
        baked({**document, "size": 0.0})
    half = baked({**document, "most": 1000, "sides": "both"})
    assert half["source"].max() == 999
    assert bake_cloud({"points": 1000}, {"subject": half}, silent)["first"].shape == (2000, 2)
