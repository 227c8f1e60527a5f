"""The ground's bake: what the default terrain becomes, and where trees may stand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from renderer.core.errors import UmbrageError
from renderer.forest.ground import RIM, bake_ground, cover_map
from renderer.forest.world_scale import CELL, NODES, STAND_TOP
from renderer.world.terrain import normals
from tests.forest import worlds

RULES: dict[str, Any] = worlds.state().cover.model_dump(mode="json")
TERRAIN = worlds.state().terrain.model_dump(mode="json")
INNER = slice(RIM, -RIM)


@pytest.fixture(scope="module")
def baked() -> dict[str, np.ndarray]:
    said: list[float] = []
    made = bake_ground({"terrain": TERRAIN, "cover": RULES}, {}, lambda share, words: said.append(share))
    assert said == sorted(said)
    return dict(made)


def test_the_default_square_is_real_land(baked: dict[str, np.ndarray]) -> None:
    assert baked["elevation"].shape == baked["cover"].shape == baked["surface"].shape == (NODES, NODES)
    assert baked["elevation"].dtype == np.float32
    assert baked["elevation"].min() == 0
    assert 100 < baked["elevation"].max() < 1000, "metres of relief over 4 km"
    assert 200 < float(baked["base"]) < 700, "metres above the sea, in Tennessee"


def test_stands_rise_where_trees_may(baked: dict[str, np.ndarray]) -> None:
    wooded = baked["cover"] > 0.5
    np.testing.assert_array_equal(baked["surface"] - baked["elevation"] > STAND_TOP / 2, wooded)


def cover(elevation: np.ndarray | float = 0.0, **rules: Any) -> np.ndarray:
    z = np.array(np.broadcast_to(np.asarray(elevation, np.float32), (NODES, NODES)))
    return cover_map(z, 300.0, {**RULES, **rules})


@pytest.mark.parametrize("share", [0.0, 0.12, 0.5, 1.0])
def test_clearings_take_their_share_of_level_land(share: float) -> None:
    found = cover(clearings=share)[INNER, INNER]
    assert (found <= 0.5).mean() == pytest.approx(share, abs=0.02)
    assert found.min() >= 0
    assert found.max() <= 1


def test_no_trees_on_steep_ground() -> None:
    x = np.arange(NODES) * CELL
    ridge = np.where(x < 2000, 0.0, (x - 2000) * 1.5)
    found = cover(ridge[None, :], clearings=0.0, steepest=48.0)[INNER]
    assert (found[:, 100:240] > 0.5).all()
    assert (found[:, 260:-RIM] < 0.5).all()
    assert (cover(ridge[None, :], clearings=0.0, steepest=60.0)[INNER, 260:-RIM] > 0.5).all()


def test_no_trees_above_the_tree_line() -> None:
    found = cover(np.linspace(0, 400, NODES)[:, None], clearings=0.0, tree_line=500.0)[INNER, INNER]
    rows = np.linspace(0, 400, NODES)[INNER]
    assert (found[rows < 199] > 0.5).all()
    assert (found[rows > 201] < 0.5).all()


def test_the_rim_bears_forest_and_seeds_differ() -> None:
    glade = cover(clearings=1.0)
    for edge in (glade[:RIM], glade[-RIM:], glade[:, :RIM], glade[:, -RIM:]):
        assert (edge == 1).all()
    assert ((cover(seed=1) > 0.5) != (cover(seed=2) > 0.5)).mean() > 0.1
    np.testing.assert_array_equal(cover(seed=3), cover(seed=3))


def test_a_lost_file_is_said() -> None:
    terrain = {"kind": "asset", "asset": "asset:" + "0" * 64, "east": 0, "north": 0, "reading": {}}
    with pytest.raises(UmbrageError):
        bake_ground({"terrain": terrain, "cover": RULES}, {}, lambda share, words: None)


def test_normals_point_away_from_the_slope() -> None:
    x = np.arange(8) * CELL
    found = normals((0.5 * x)[None, :].repeat(8, axis=0), (CELL, CELL))
    np.testing.assert_allclose(found, np.broadcast_to(np.array([-0.5, 0, 1]) / np.sqrt(1.25), (8, 8, 3)), atol=1e-6)
