"""The user's maps of the forest: density, canopy heights, tree line; read, laid over the square, and drawn as said."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from renderer.core.cache import AssetStore
from renderer.core.errors import InputError
from renderer.forest.geometry.ray_march import RayMarch
from renderer.forest.geometry.slices import Slices
from renderer.forest.ground import RIM, bake_ground, presence_map
from renderer.forest.planting import RANKS, Standing, ranked
from renderer.forest.stand_maps import density_map, stand_of
from renderer.forest.tiles import RHOMBI, lattice
from renderer.forest.world_scale import CANOPY_HEIGHT, CELL, NODES, PRESENCE_SIDE, TILE_SIDE, VOXEL
from tests.forest import worlds
from tests.forest.slabs import ALPHA, trace

RULES: dict[str, Any] = worlds.state().cover.model_dump(mode="json")
BUILT_IN = worlds.state().terrain.model_dump(mode="json")


@pytest.fixture
def store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> AssetStore:
    monkeypatch.setenv("UMBRAGE_CACHE", str(tmp_path))
    return AssetStore()


def kept(store: AssetStore, path: Path) -> str:
    return f"asset:{store.put(path.read_bytes(), 'any', path.name)}"


def baked(rules: dict[str, Any], **inputs: Any) -> Any:
    return bake_ground({"terrain": BUILT_IN, "cover": {**RULES, **rules}}, inputs, lambda share, words: None)


def test_a_density_map_thins_the_forest_where_it_is_dark(store: AssetStore, tmp_path: Path) -> None:
    picture = np.full((50, 80), 255, np.uint8)
    picture[:25, 40:] = 0  # the north-east
    picture[25:, 40:] = 128
    Image.fromarray(picture).save(tmp_path / "density.png")
    made = baked({"density_map": kept(store, tmp_path / "density.png"), "clearings": 0.0, "steepest": 89.0})
    half, edge = PRESENCE_SIDE // 2, 40
    quarter = {
        (north, east): made["presence"][slice(edge, half - edge) if north else slice(half + edge, -edge),
                                        slice(half + edge, -edge) if east else slice(edge, half - edge)] / 255
        for north in (0, 1) for east in (0, 1)
    }
    assert quarter[1, 1].max() == 0
    assert quarter[0, 1].mean() == pytest.approx(128 / 255, abs=0.01)
    assert quarter[0, 0].min() == quarter[1, 0].min() == 1
    assert (made["cover"][RIM + 12 : NODES // 2 - 12, NODES // 2 + 12 : -RIM - 12] < 0.5).all(), "open ground"


def test_a_density_beyond_its_full_value_is_refused(store: AssetStore, tmp_path: Path) -> None:
    np.savez(tmp_path / "x.npz", density=np.array([[0.0, 60.0], [100.0, 30.0]]))
    rules = {"density_map": kept(store, tmp_path / "x.npz"), "density_full": 0.0}
    with pytest.raises(InputError, match="100 for per cent") as refused:
        density_map(rules)
    assert refused.value.field == "cover.density_full"
    assert density_map({**rules, "density_full": 100.0}).max() == pytest.approx(1)
    with pytest.raises(InputError, match="no uploaded file") as refused:
        density_map({**rules, "density_map": "asset:" + "0" * 64})
    assert refused.value.field == "cover.density_map"


def test_a_share_of_the_ranks_is_a_share_of_the_trees_and_even() -> None:
    rng, base = np.random.default_rng(3), lattice(TILE_SIDE)
    feet = rng.uniform(0, RHOMBI, (600, 2)) @ base
    trees = ranked([Standing(0, 1, 1, 0, foot, np.array([[0, 0]]), 3, 4) for foot in feet], base)
    rank = np.array([tree.rank for tree in trees])
    assert np.bincount(rank, minlength=RANKS).max() <= 5
    few = feet[rank < RANKS // 8]
    assert len(few) == pytest.approx(75, abs=5)

    def nearest(points: np.ndarray) -> float:
        apart = np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1))
        return float(np.sort(apart, axis=1)[:, 1].min())

    chance = [nearest(feet[rng.choice(600, len(few), replace=False)]) for _ in range(5)]
    assert nearest(few) > 3 * max(chance)


def test_the_forest_thins_out_towards_the_tree_line_and_grows_higher_in_the_sun() -> None:
    # A valley from west to east, 200 m deep: one slope faces south, the other north.
    across = np.abs(np.linspace(-1, 1, NODES))[:, None] * 600.0 * np.ones((1, NODES))
    rules = {**RULES, "clearings": 0.0, "steepest": 89.0, "tree_line": 300.0, "tree_line_width": 100.0}
    share = presence_map(across, 0.0, rules)[:, PRESENCE_SIDE // 2]
    height = np.abs(np.linspace(-1, 1, PRESENCE_SIDE)) * 600
    np.testing.assert_allclose(share[40:-40], np.clip(0.5 + (300 - height) / 100, 0, 1)[40:-40], atol=0.03)
    sunny = {**rules, "tree_line_aspect": 100.0}
    share = presence_map(across, 0.0, sunny)[:, PRESENCE_SIDE // 2]
    faces_south, faces_north = share[40 : PRESENCE_SIDE // 2], share[PRESENCE_SIDE // 2 : -40][::-1]
    slope = 1200 / (NODES * CELL)
    gained = (faces_south.sum() - faces_north.sum()) * 1200 / PRESENCE_SIDE
    assert gained == pytest.approx(2 * 100 * slope, rel=0.1)


def canopy(size: int = 512) -> np.ndarray:
    """Heights at 8 m: nothing in the west, a stand of 6 m in the south-east, of 24 m in the north-east."""
    made = np.zeros((size, size), np.float32)
    made[: size // 2, size // 2 :] = 24
    made[size // 2 :, size // 2 :] = 6
    return made


def test_the_forest_grows_where_and_as_tall_as_the_survey_says(store: AssetStore, tmp_path: Path) -> None:
    np.savez(tmp_path / "chm.npz", elevation=canopy(), cell_size=(CELL, CELL))
    pattern = worlds.uniform(200, layers=slice(0, 20))
    closed, own = stand_of(pattern, 2.0)
    assert (closed, own) == (1.0, pytest.approx(19.5 * CANOPY_HEIGHT / 32))
    made = baked({"canopy_model": kept(store, tmp_path / "chm.npz"), "clearings": 0.5}, pattern=pattern)
    half, edge = NODES // 2, 20
    inner = slice(edge, half - edge), slice(half + edge, -edge)
    assert (made["presence"][2 * edge : -2 * edge, 2 * edge : PRESENCE_SIDE // 2 - 2 * edge] == 0).all()
    assert (made["presence"][2 * edge : -2 * edge, PRESENCE_SIDE // 2 + 2 * edge : -2 * edge] == 255).all()
    np.testing.assert_allclose(made["growth"][inner[0], inner[1]] * own, 24, rtol=1e-3)
    np.testing.assert_allclose(made["growth"][half + edge : -edge, inner[1]] * own, 6, rtol=1e-3)
    rise = made["surface"] - made["elevation"]
    assert rise[inner].mean() == pytest.approx(4 * rise[half + edge : -edge, inner[1]].mean(), rel=0.01)


def test_a_survey_that_cannot_serve_is_refused(store: AssetStore, tmp_path: Path) -> None:
    for heights, words in ((canopy() + 400, "elevation model"), (canopy() / 100, "nothing higher"),
                           (np.where(canopy() > 20, np.nan, canopy()), "holes")):
        np.savez(tmp_path / "chm.npz", elevation=heights, cell_size=(CELL, CELL))
        with pytest.raises(InputError, match=words) as refused:
            baked({"canopy_model": kept(store, tmp_path / "chm.npz")}, pattern=worlds.uniform(200))
        assert refused.value.field == "cover.canopy_model"


RAMP = 0.004
"""Growth of the stand a metre to the east: from 0.2 in the west to 1.8 in the east, within 200 m of the middle."""


def ramp() -> dict[str, np.ndarray]:
    """Level ground, whose stand is taller to the east."""
    x = np.clip((np.arange(NODES) - (NODES - 1) / 2) * CELL, -200, 200)
    return worlds.ground() | {"growth": np.broadcast_to(1 + RAMP * x, (NODES, NODES)).astype(np.float32)}


def stretched_error(ask: Callable[..., Any], technique: Any) -> float:
    """Worst error of the transmittance to the ground under a stand whose height changes along the ray."""
    worst = 0.0
    for x, direction in ((-120.0, (0, 0, -1)), (100.0, (0.6, 0, -0.8)), (-60.0, (-0.5, 0.3, -0.6))):
        d = np.asarray(direction) / np.linalg.norm(direction)
        start = 1.7 * CANOPY_HEIGHT  # under the tallest stand's top, over this one's
        enter = (start - CANOPY_HEIGHT * (1 + RAMP * x)) / (CANOPY_HEIGHT * RAMP * d[0] - d[2])
        exact = (1 - ALPHA / 255) ** ((start / -d[2] - enter) / VOXEL)
        found = trace(ask, technique, (x, 3.0, start), d, worlds.uniform(ALPHA), ramp(), local=True)
        worst = max(worst, abs(float(found[:, 0].mean()) - exact))
    return worst


@pytest.mark.parametrize("technique", [RayMarch(first=1, step=0.5, stop=0), Slices(count=64)])
def test_a_stand_is_as_tall_as_the_place_says(ask: Callable[..., Any], technique: Any) -> None:
    assert stretched_error(ask, technique) < 0.015


@pytest.mark.parametrize(("right", "wrong"), [
    ("canopy_height * textureLod(growth, terrain_coordinate(xy), 0.0).r", "canopy_height"),
    ("canopy_height * textureLod(growth, terrain_coordinate(xy), 0.0).r",
     "canopy_height / textureLod(growth, terrain_coordinate(xy), 0.0).r"),
])
def test_a_wrong_height_is_found(ask: Callable[..., Any], spoil: Callable, right: str, wrong: str) -> None:
    with spoil("forest/world.glsl", right, wrong):
        assert stretched_error(ask, RayMarch(first=1, step=0.5, stop=0)) > 0.05
