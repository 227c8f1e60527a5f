"""Thin parts and open meshes: shares that are known beforehand."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.core.baking import bake_now
from renderer.core.cache import Cache
from renderer.core.technique import Bake
from renderer.directional.cloud import Cloud, bake_cloud, cloud_bake
from renderer.directional.subjects import box_of
from renderer.directional.visibility import Visibility, visibility_bake
from renderer.directional.visibility_failures import missed_share, turned_share
from renderer.world.mesh_normals import corner_normals


def silent(share: float, words: str) -> None:
    pass


def arrays(vertices: np.ndarray, faces: np.ndarray, two_sided: bool) -> dict[str, np.ndarray]:
    return {
        "vertices": vertices, "faces": faces.astype(np.int32), "normals": corner_normals(vertices, faces),
        "colour": np.full((len(faces), 3), 0.5), "two_sided": np.asarray(two_sided), "box": box_of(vertices, faces),
    }


def threads(count: int, width: float) -> dict[str, np.ndarray]:
    """Level strips of a width across the unit square, at places that no grid of texels knows."""
    at = np.sort(np.arange(count) * 0.6180339887 % 1) * (1 - width)
    low = np.stack([at, 0 * at, 0 * at], axis=1)
    corners = np.stack([low, low + [width, 0, 0], low + [width, 1, 0], low + [0, 1, 0]], axis=1)
    faces = (4 * np.arange(count)[:, None, None] + np.array([(0, 1, 2), (0, 2, 3)])).reshape(-1, 3)
    return arrays(corners.reshape(-1, 3), faces, two_sided=True)


def bowl(two_sided: bool) -> dict[str, np.ndarray]:
    """The lower half of a ball, seen from outside."""
    turn, rise = np.meshgrid(np.arange(32) / 32 * 2 * np.pi, -np.linspace(0.0, np.pi / 2 - 0.01, 12))
    place = np.stack([np.cos(turn) * np.cos(rise), np.sin(turn) * np.cos(rise), np.sin(rise)], axis=-1).reshape(-1, 3)
    row, column = np.arange(11)[:, None], np.arange(32)
    a, b = row * 32 + column, row * 32 + (column + 1) % 32
    faces = np.stack([np.stack([a, a + 32, b + 32], -1), np.stack([a, b + 32, b], -1)], axis=2).reshape(-1, 3)
    return arrays(place, faces, two_sided)


def test_threads_thinner_than_a_texel_are_missed_by_their_width() -> None:
    made = threads(12, 1 / 128)
    cloud = bake_cloud({"points": 5000}, {"subject": made}, silent)
    width = float(made["box"][1, 0] - made["box"][0, 0])
    for texels in (32, 64):
        # A texel's middle falls on a thread as often as the thread is wide, in widths of a texel: 144 times chance,
        # for each direction shifts them otherwise, so within three deviations of 0.036.
        expected = 1 - texels / width / 128
        assert missed_share(made, cloud, texels, faces=(5,)) == pytest.approx(expected, abs=0.11)


def test_a_wide_plate_misses_its_edge_alone() -> None:
    made = threads(1, 0.9)
    cloud = bake_cloud({"points": 5000}, {"subject": made}, silent)
    assert missed_share(made, cloud, 32, faces=(5,)) < 0.02


@pytest.mark.parametrize("two_sided", [False, True])
def test_the_inside_of_an_open_bowl_looks_away(two_sided: bool, tmp_path) -> None:
    made = bowl(two_sided)
    assert (made["normals"][:, 0] * made["vertices"][made["faces"][:, 0]]).sum(axis=1).min() > 0.9
    subject = Bake("subject", _given, {"two_sided": two_sided})
    cloud = cloud_bake(Cloud(points=5000), subject)
    cache = Cache(tmp_path)
    seen = bake_now(visibility_bake(Visibility(texels=32, directions=33), subject, cloud), cache)
    share = turned_share(bake_now(cloud, cache), seen)
    if two_sided:
        assert share < 0.01
    else:
        assert 0.2 < share < 0.7  # from above all that is seen, from below nothing


def _given(arguments: dict, inputs: dict, progress) -> dict[str, np.ndarray]:
    return bowl(arguments["two_sided"])
