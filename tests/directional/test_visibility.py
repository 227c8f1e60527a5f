"""What the faces of a box see: parallel rays in the faces' own axes, packed without loss."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.core.baking import bake_now
from renderer.core.cache import Cache
from renderer.core.errors import Cancelled
from renderer.core.params import bake_arguments
from renderer.directional import visibility
from renderer.directional.casting import AXES, NONE, face_frame, face_middles
from renderer.directional.cloud import Cloud, cloud_bake
from renderer.directional.hemisphere import hemisphere_of
from renderer.directional.index_code import packed, unpacked
from renderer.directional.subject import knot
from renderer.directional.subjects import subject_bake
from renderer.directional.visibility import FACES, Visibility, layer, visibility_bake


@pytest.fixture(scope="module")
def baked(tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict[str, np.ndarray]]:
    cache = Cache(tmp_path_factory.mktemp("cache"))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(knot, "ALONG", 700)
        patch.setattr(knot, "AROUND", 30)
        subject = subject_bake(knot.Knot())
        cloud = cloud_bake(Cloud(points=40_000), subject)
        made = visibility_bake(Visibility(texels=32, directions=33), subject, cloud)
        return {bake.name: bake_now(bake, cache) for bake in (subject, cloud, made)}


@pytest.mark.parametrize("face", range(FACES))
def test_a_face_has_its_own_axes(face: int) -> None:
    box = np.array([(-1.0, -2.0, -3.0), (4.0, 5.0, 6.0)])
    frame = face_frame(face)
    place = face_middles(box, face, 4).reshape(4, 4, 3)
    assert ((place[0, 1] - place[0, 0]) @ frame.T > 0).tolist() == [True, False, False]
    assert ((place[1, 0] - place[0, 0]) @ frame.T > 0).tolist() == [False, True, False]
    assert (place[..., AXES[face][2]] == box[face % 2, AXES[face][2]]).all()
    assert frame[2] @ (place.mean(axis=(0, 1)) - box.mean(axis=0)) > 0


def test_texels_see_points_on_their_ray(baked: dict[str, dict[str, np.ndarray]]) -> None:
    made, position = baked["visibility"], baked["cloud"]["position"][baked["visibility"]["used"]]
    directions = hemisphere_of(33).directions()
    # A ray meets the triangle part that a point stands in the middle of, or that it has for its neighbours.
    reach = 4 * float(baked["cloud"]["spacing"])
    for face in range(FACES):
        origin = face_middles(made["box"], face, 32)
        for number in (0, 13, 32):
            towards = directions[number] @ face_frame(face)
            points = layer(made, face, number).reshape(-1)
            seen = points != NONE
            assert 0.02 < seen.mean() < 0.98
            away = position[points[seen]] - origin[seen]
            off = np.linalg.norm(np.cross(away, towards), axis=1)
            assert off.max() < reach
            turned = np.linalg.norm(np.cross(away, towards * [-1, 1, 1] if face > 1 else towards * [1, -1, 1]), axis=1)
            assert number == 32 or turned.max() > reach  # a mirrored direction is told apart


def test_nothing_stands_before_what_is_seen(baked: dict[str, dict[str, np.ndarray]]) -> None:
    made, cloud = baked["visibility"], baked["cloud"]
    points = layer(made, 5, 32)
    seen = points != NONE
    top = cloud["position"][made["used"][points[seen]], 2]
    x, y = np.moveaxis(face_middles(made["box"], 5, 32).reshape(32, 32, 3)[seen][:, :2], 1, 0)
    spacing = float(cloud["spacing"])
    for k in range(0, len(top), 7):
        near = np.hypot(cloud["position"][:, 0] - x[k], cloud["position"][:, 1] - y[k]) < spacing / 3
        assert not near.any() or cloud["position"][near, 2].max() < top[k] + 5 * spacing


def test_points_that_no_texel_sees_are_dropped(baked: dict[str, dict[str, np.ndarray]]) -> None:
    made = baked["visibility"]
    found = np.zeros(len(made["used"]), bool)
    for face in range(FACES):
        for number in range(33):
            points = layer(made, face, number)
            found[points[points != NONE]] = True
    assert found.all()
    assert 0.2 < len(made["used"]) / len(baked["cloud"]["position"]) < 0.95
    assert (np.diff(made["used"]) > 0).all()


@pytest.mark.parametrize("share", [0.0, 0.4, 1.0])
def test_a_layer_is_packed_without_loss(share: float) -> None:
    rng = np.random.default_rng(4)
    numbers = rng.integers(0, 1 << 24, 1000).astype(np.uint32)
    numbers[rng.uniform(size=1000) >= share] = NONE
    data = packed(numbers)
    assert (unpacked(data, 1000) == numbers).all()
    assert not (unpacked(packed(numbers[::-1]), 1000) == numbers).all() or share == 0


def test_a_stopped_bake_goes_on_where_it_was(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(knot, "ALONG", 160)
    monkeypatch.setattr(knot, "AROUND", 15)
    cache = Cache(tmp_path)
    subject = subject_bake(knot.Knot())
    cloud = cloud_bake(Cloud(points=5000), subject)
    whole = visibility_bake(Visibility(texels=16, directions=33), subject, cloud)
    assert len(whole.inputs) == 2
    monkeypatch.setattr(visibility, "WORTH_KEEPING", 0.0)
    bake = visibility_bake(Visibility(texels=16, directions=33), subject, cloud)
    assert len(bake.inputs) == 7
    told: list[str] = []

    def stop(progress) -> None:
        told.append(progress.words)
        if "face 4" in progress.words:
            raise Cancelled("enough")

    with pytest.raises(Cancelled):
        bake_now(bake, cache, stop)
    told.clear()
    parts = bake_now(bake, cache, lambda progress: told.append(progress.words))
    assert any("face 4" in words for words in told)
    assert not any("face 3" in words for words in told)
    joined = bake_now(whole, cache)
    assert all((joined[name] == parts[name]).all() for name in parts)


def test_its_arguments_are_the_documents() -> None:
    assert bake_arguments(Visibility(texels=64, directions=129)) == {"texels": 64, "directions": 129}
    assert bake_arguments(Cloud(position_bits=8)) == bake_arguments(Cloud())
