"""Blocks of a picture: no point shows outside of those that are found, nor before or beyond their distances."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from renderer.core.params import validate
from renderer.directional import tiles
from renderer.directional.state import DirectionalState
from renderer.directional.tiles import FAR, TILE, bounds, occupied, runs
from renderer.world.camera import Orthographic, pose

BOX = np.array([[-1.0, -0.5, 0.0], [1.0, 0.5, 0.7]])
SIZE = (203, 150)
CAMERAS: dict[str, dict[str, Any]] = {
    "orbit": {"kind": "orbit", "target": [0, 0, 0.3], "distance": 4, "azimuth": 30, "elevation": 25},
    "beside": {"kind": "look", "eye": [0.5, -1.4, 0.6], "target": [0.8, 0, 0.2], "up": [0, 0, 1], "field_of_view": 70},
    "parallel": {"kind": "orthographic", "centre": [0, 0, 0.3], "direction": [1, 2, -1], "up": [0, 0, 1], "width": 2.5},
}


def points() -> np.ndarray:
    """(400, 3) m: few enough that many cubes are empty."""
    return np.random.default_rng(0).uniform(BOX[0], BOX[1], (400, 3))


def outside(camera: Any) -> int:
    """How many points show in no block, or out of its distances."""
    at, middle = pose(camera), BOX.mean(axis=0)
    found = bounds(*occupied(points(), BOX), 0.0, camera, middle, SIZE)
    away = points() - at.eye
    x, y, z = away @ at.right, away @ at.up, away @ at.forward
    parallel = isinstance(camera, Orthographic)
    scale = SIZE[0] / camera.width if parallel else SIZE[1] / 2 / np.tan(np.radians(camera.field_of_view) / 2)
    column = (SIZE[0] / 2 + scale * x / (1 if parallel else z)) // TILE
    row = (SIZE[1] / 2 + scale * y / (1 if parallel else z)) // TILE
    inside = (column >= 0) & (column < found.shape[1]) & (row >= 0) & (row < found.shape[0])
    near, far = found[row[inside].astype(int), column[inside].astype(int)].T
    distance = (z if parallel else np.linalg.norm(away, axis=1))[inside]
    assert inside.sum() > 100
    return int(((distance < near) | (distance > far)).sum())


@pytest.fixture(params=CAMERAS)
def camera(request: pytest.FixtureRequest) -> Any:
    """Cameras far off, near by and at no distance."""
    return validate(DirectionalState, {"camera": CAMERAS[request.param]}).camera


def test_every_point_lies_within_its_block(camera: Any) -> None:
    assert outside(camera) == 0


def test_cubes_that_are_too_small_are_found(camera: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = tiles.occupied
    monkeypatch.setitem(globals(), "occupied", lambda *given: (whole(*given)[0], -0.9 * whole(*given)[1]))
    assert outside(camera) > 0


def test_most_of_a_picture_is_left_out() -> None:
    one = np.array([[0.0, 0.0, 0.35]])
    camera = validate(DirectionalState, {"camera": CAMERAS["orbit"]}).camera
    cells, side = occupied(one, BOX)
    found = bounds(cells, side, 0.0, camera, BOX.mean(axis=0), SIZE)
    shown = found[..., 0] < found[..., 1]
    assert 1 <= shown.sum() <= 4
    near, far = found[shown][0]
    assert near < np.linalg.norm(pose(camera).eye - one[0]) < far
    assert far - near < 3 * side
    assert (found[~shown, 0] == np.float32(FAR)).all()


def test_from_within_everything_is_looked_at() -> None:
    camera = validate(DirectionalState, {"camera": {**CAMERAS["beside"], "eye": [0.1, 0, 0.3]}}).camera
    found = bounds(*occupied(points(), BOX), 0.0, camera, BOX.mean(axis=0), SIZE)
    assert (found[..., 0] < 0).all()
    assert (found[..., 1] == np.float32(FAR)).all()


def test_rows_of_blocks_are_joined() -> None:
    shown = np.array([[1, 1, 0, 1], [0, 0, 0, 0], [0, 1, 1, 1]], bool)
    covered = np.zeros(shown.shape, int)
    for left, bottom, right, top in runs(shown):
        covered[bottom:top, left:right] += 1
    np.testing.assert_array_equal(covered, shown)
    assert len(runs(shown)) == 3
