"""Sunlight as a measurable quantity: what it answers, and what it refuses."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from renderer.core.errors import InputError, LimitError
from renderer.study import measure as door
from renderer.study import sunlight

DAY = {"start": "2024-06-21", "end": "2024-06-21", "latitude": 45.0, "longitude": 6.0}


@pytest.fixture
def wall(tmp_path: Path) -> Path:
    """A plain under a wall that stands to the east."""
    elevation = np.full((9, 12), 800.0, np.float32)
    elevation[:, 8:] += 120.0
    path = tmp_path / "wall.npz"
    np.savez(path, elevation=elevation, cell_size=(30.0, 30.0))
    return path


def test_the_sun_rises_later_under_a_wall(wall: Path) -> None:
    found = door.measure("sunlight", {**DAY, "points": [[4, 1], [4, 6], [4, 10]]}, {"terrain": wall})
    far, near, top = found.arrays["hours"]
    assert near < far < top == pytest.approx(15.5, abs=0.3)
    assert np.all(found.arrays["diffuse"] < found.arrays["insolation"])
    assert found.arrays["sky"][2] == 1.0
    assert "a plain there has 15.75 h" in found.meta["notes"][0]
    whole = door.measure("sunlight", DAY, {"terrain": wall})
    assert whole.arrays["hours"].shape == (9, 12)
    assert whole.arrays["row_col"].shape == (9, 12, 2)
    np.testing.assert_array_equal(whole.arrays["hours"][4, [1, 6, 10]], [far, near, top])


def test_under_trees_there_is_no_value(wall: Path, tmp_path: Path) -> None:
    heights = np.zeros((9, 12), np.float32)
    heights[:, :3] = 15.0
    canopy = tmp_path / "canopy.npz"
    np.savez(canopy, elevation=heights, cell_size=(30.0, 30.0))
    files = {"terrain": wall, "canopy": canopy}
    found = door.measure("sunlight", DAY, files)
    np.testing.assert_array_equal(np.isnan(found.arrays["hours"]), heights > 0)
    assert json.loads(json.dumps(found.as_json(), allow_nan=False))["hours"][0][0] is None
    tops = door.measure("sunlight", {**DAY, "receiver": "canopy"}, files).arrays["hours"]
    bare = door.measure("sunlight", {**DAY, "receiver": "bare_ground"}, files).arrays["hours"]
    assert np.all(tops[:, 0] >= bare[:, 0])
    assert not np.isnan(tops).any()


@pytest.mark.parametrize(
    ("arguments", "field"),
    [
        ({"latitude": None}, "latitude"),
        ({"points": [[9, 0]]}, "points"),
        ({"receiver": "canopy"}, "receiver"),
        ({"end": "2024-06-20"}, "end"),
    ],
)
def test_what_cannot_be_answered_is_said(wall: Path, arguments: dict[str, object], field: str) -> None:
    with pytest.raises(InputError) as refused:
        door.measure("sunlight", {**DAY, **arguments}, {"terrain": wall})
    assert refused.value.field == field


def test_a_whole_land_is_a_study_s(wall: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sunlight, "NODES", 100)
    with pytest.raises(LimitError, match="9 x 12 nodes are too many"):
        door.measure("sunlight", DAY, {"terrain": wall})
