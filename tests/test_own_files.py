"""The user's own terrain and tree: kept, named in a document, and refused in the document's own words."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from renderer.core.cache import AssetStore
from renderer.core.errors import InputError, InvalidDocument
from renderer.core.params import bake_arguments, validate
from renderer.forest.ground import square
from renderer.forest.nursery import nursery, own_trees
from renderer.forest.state import Canopy, UserTerrain
from renderer.session import Session
from renderer.world.mesh import load_mesh
from renderer.world.terrain import TerrainReading

HILL = (np.hypot(*np.mgrid[-30:31, -40:41]) * -2).astype(np.float32)


@pytest.fixture
def store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> AssetStore:
    """An empty store where bakes look for files."""
    monkeypatch.setenv("UMBRAGE_CACHE", str(tmp_path))
    return AssetStore()


def kept(store: AssetStore, tmp_path: Path, name: str, **arrays: Any) -> str:
    path = tmp_path / name
    if arrays:
        np.savez(path, **arrays)
    else:
        cone = trimesh.creation.cone(2, 9)
        if path.suffix == ".glb":  # whose up is y
            cone.vertices = cone.vertices[:, [0, 2, 1]] * (1, 1, -1)
        data = cone.export(file_type=path.suffix[1:])
        path.write_bytes(data.encode() if isinstance(data, str) else data)
    return f"asset:{store.put(path.read_bytes(), 'any', name)}"


def test_a_terrain_of_ones_own_becomes_the_ground(store: AssetStore, tmp_path: Path) -> None:
    asset = kept(store, tmp_path, "hill.npz", elevation=HILL, cell_size=(80.0, 100.0))
    heights = square(bake_arguments(UserTerrain(asset=asset)))[0]
    middle = len(heights) // 2
    assert heights[middle, middle] > heights.max() - 1, "its summit in the middle"
    assert heights.max() - heights[middle, 0] == pytest.approx(2 * 2048 / 80, rel=0.02), "a cone of 2 m a node"
    moved = square(bake_arguments(UserTerrain(asset=asset, north=-1000.0)))[0]
    assert moved.max() == moved[: middle // 2 + 8].max(), "the summit lies north of the square's centre"


@pytest.mark.parametrize(
    ("arrays", "change", "field", "words"),
    [
        ({"elevation": HILL}, {}, "terrain.reading.cell_size", "must be said"),
        ({"elevation": np.where(HILL > -5, np.nan, HILL), "cell_size": (80.0, 80.0)}, {}, "terrain.asset", "holes"),
        ({"elevation": HILL, "cell_size": (80.0, 80.0)}, {"east": 9e4}, "terrain.east", "outside"),
        ({}, {}, "terrain.asset", "no elevation model"),
    ],
)
def test_a_terrain_that_cannot_serve_names_the_field(
    store: AssetStore, tmp_path: Path, arrays: dict[str, Any], change: dict[str, Any], field: str, words: str
) -> None:
    asset = kept(store, tmp_path, "hill.npz" if arrays else "hill.ply", **arrays)
    with pytest.raises(InputError, match=words) as refused:
        square(bake_arguments(UserTerrain(asset=asset, **change)))
    assert refused.value.field == field
    if "holes" in words:
        filled = square(bake_arguments(UserTerrain(asset=asset, reading=TerrainReading(holes="fill"))))[0]
        assert np.isfinite(filled).all()


def test_a_file_that_is_not_there_names_the_field(store: AssetStore) -> None:
    nothing = "asset:" + "0" * 64
    for field, ask in (
        ("terrain.asset", lambda: square(bake_arguments(UserTerrain(asset=nothing)))),
        ("canopy.mesh", lambda: nursery(bake_arguments(Canopy(mesh=nothing)))),
    ):
        with pytest.raises(InputError, match="no uploaded file") as refused:
            ask()
        assert refused.value.field == field


@pytest.mark.parametrize("ending", ["ply", "obj", "stl", "off", "glb"])
def test_a_tree_of_ones_own_is_planted(store: AssetStore, tmp_path: Path, ending: str) -> None:
    trees, shares, _ = nursery(bake_arguments(Canopy(mesh=kept(store, tmp_path, f"tree.{ending}"))))
    assert (len(trees), shares.sum()) == (1, 1.0)
    heights = trees[0].vertices[:, 2]
    assert (heights.min(), heights.max()) == pytest.approx((0.0, 18.0), abs=0.01)


def test_several_trees_keep_their_sizes_beside_one_another(store: AssetStore, tmp_path: Path) -> None:
    tall, small = (trimesh.creation.cone(1, height) for height in (9, 3))
    names = []
    for number, mesh in enumerate((tall, small)):
        path = tmp_path / f"tree{number}.ply"
        path.write_bytes(mesh.export(file_type="ply"))
        names.append(f"asset:{store.put(path.read_bytes(), 'mesh', path.name)}")
    trees, shares, kinds = nursery(bake_arguments(Canopy(mesh=" ".join(names))))
    assert [tree.height for tree in trees] == pytest.approx([18.0, 6.0], abs=0.01)
    assert shares.tolist() == [0.5, 0.5]
    assert len(set(kinds)) == 2
    own_trees([load_mesh(tmp_path / "tree0.ply")])
    (tmp_path / "shrub.ply").write_bytes(trimesh.creation.cone(0.3, 0.5).export(file_type="ply"))
    with pytest.raises(InputError, match=r"number 2 is 0\.5 tall.*same unit"):
        own_trees([load_mesh(tmp_path / name) for name in ("tree0.ply", "shrub.ply")])
    with pytest.raises(InvalidDocument):
        validate(Canopy, {"mesh": " ".join(names[:1] * 9)})


def test_what_was_said_beside_a_file_comes_back_with_it(store: AssetStore, tmp_path: Path) -> None:
    path = tmp_path / "upload"
    with path.open("wb") as file:
        np.savez(file, elevation=np.where(HILL > -5, np.nan, HILL), cell_size=(80.0, 80.0))
    with Session(assets=store) as session:
        with pytest.raises(InputError, match="holes = fill"):
            session.add_asset(path, "holed.npz")
        stored = session.add_asset(path, "holed.npz", {"holes": "fill"})
    assert stored["reading"] == {"holes": "fill"}
    assert "filled" in stored["preview"]["notes"]
    assert np.isfinite(square(bake_arguments(UserTerrain.model_validate(
        {"asset": stored["asset"], "reading": stored["reading"]})))[0]).all()
