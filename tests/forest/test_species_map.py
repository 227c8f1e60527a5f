"""The user's map of species: read, planted for, and drawn by the foot of each tree."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from renderer import view
from renderer.core.cache import AssetStore
from renderer.core.errors import InputError
from renderer.forest.bakes import ground_bake, pattern_bake
from renderer.forest.ground import RIM, bake_ground
from renderer.forest.land_shadow import bake_stand_tops, shadow_bounds
from renderer.forest.nursery import bands_of, listed, nursery
from renderer.forest.planting import BAND_RANKS, BANDS, NEARNESS, SPACING, banded, mixed_share, plant
from renderer.forest.program import trace_source
from renderer.forest.shadow.sun_march import SunMarch
from renderer.forest.stand_maps import species_map
from renderer.forest.tiles import RHOMBI
from renderer.forest.world_arrays import world_arrays
from renderer.forest.world_scale import CELL, NODES, PRESENCE_SIDE, TILE_SIDE, VOXEL
from renderer.reference.forest import render
from renderer.reference.forest_world import ForestWorld
from renderer.study.metrics import relative_rmse
from renderer.world.camera import rays
from renderer.world.sampling import offset, offsets
from renderer.world.sun import angles
from tests.forest import worlds
from tests.forest.truth import MARCH, REFERENCE_OPTIONS, SCENE, SKY, _baked

SIDE = NODES * CELL
RULES: dict[str, Any] = worlds.state().cover.model_dump(mode="json")
BUILT_IN = worlds.state().terrain.model_dump(mode="json")
LISTED = {"broadleaf": False, "conifer": True, "birch": True}
NO_FILE = "asset:" + "0" * 64
RNG = np.random.default_rng(5)
BUDGET = 1.1 * (MARCH + 0.012)
"""Relative RMSE of the sun march in the grove without a map (README), and a tenth for another rasteriser."""


@pytest.fixture
def store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> AssetStore:
    monkeypatch.setenv("UMBRAGE_CACHE", str(tmp_path))
    return AssetStore()


def kept(store: AssetStore, path: Path) -> str:
    return f"asset:{store.put(path.read_bytes(), 'any', path.name)}"


def test_the_nearest_pixel_is_read_and_never_a_mixture_of_two(store: AssetStore, tmp_path: Path) -> None:
    painted = np.array([[2, 3, 0], [3, 3, 2]], np.uint8)
    Image.fromarray(painted).save(tmp_path / "species.png")
    found = species_map({"species_map": kept(store, tmp_path / "species.png")}, LISTED)
    at = (np.arange(PRESENCE_SIDE) + 0.5) / PRESENCE_SIDE
    np.testing.assert_array_equal(found, painted[np.ix_((at * 2).astype(int), (at * 3).astype(int))])


def test_a_mixture_is_thinned_to_the_density_of_one_species(store: AssetStore, tmp_path: Path) -> None:
    np.savez(tmp_path / "x.npz", species=np.array([[0, 2]]))
    rules = {**RULES, "clearings": 0.0, "steepest": 89.0, "species_map": kept(store, tmp_path / "x.npz")}
    made = bake_ground({"terrain": BUILT_IN, "cover": rules, "planted": LISTED}, {}, lambda share, words: None)
    np.testing.assert_array_equal(made["sections"], [0, 0, 1, 2])
    inner = made["presence"][4 * RIM : -4 * RIM]
    assert (inner[:, PRESENCE_SIDE // 2 : -4 * RIM] == 255).all()
    assert (inner[:, 4 * RIM : PRESENCE_SIDE // 2] == round(255 * mixed_share(2))).all()


@pytest.mark.parametrize(("values", "words"), [
    ([[4]], "has the value 4 (allowed: 0 where all are mixed, 1 broadleaf, 2 conifer, 3 birch"),
    ([[-1]], "has the value -1"), ([[2.5]], "has the value 2.5"), ([[np.nan]], "not finite"),
    ([[2, 1]], "has the value 1, but canopy.broadleaf is 0"), ([2, 3], "of shape"),
])
def test_a_map_that_names_no_planted_species_is_refused(
    store: AssetStore, tmp_path: Path, values: Any, words: str
) -> None:
    np.savez(tmp_path / "x.npz", species=np.array(values))
    with pytest.raises(InputError) as refused:
        species_map({"species_map": kept(store, tmp_path / "x.npz")}, LISTED)
    assert refused.value.field == "cover.species_map"
    assert words in str(refused.value)


def test_a_file_without_a_map_is_refused(store: AssetStore, tmp_path: Path) -> None:
    np.savez(tmp_path / "x.npz", density=np.ones((2, 2)))
    for asset, words in ((NO_FILE, "no uploaded file"), (kept(store, tmp_path / "x.npz"), "density")):
        with pytest.raises(InputError, match=words) as refused:
            species_map({"species_map": asset}, LISTED)
        assert refused.value.field == "cover.species_map"


def test_only_a_map_changes_what_is_baked_and_built() -> None:
    plain, mapped = worlds.state(), worlds.state(cover={"species_map": NO_FILE}, canopy={"birch": 0.0})
    assert "apart" not in pattern_bake(plain).arguments
    assert "planted" not in ground_bake(plain).arguments
    assert pattern_bake(mapped).arguments["apart"]
    assert ground_bake(mapped).arguments["planted"] == {"broadleaf": True, "conifer": True, "birch": False}
    assert "#define SPECIES_MAP 0" in trace_source(plain).text
    assert "#define SPECIES_MAP 3" in trace_source(mapped).text, "two species, and their mixture"


def test_own_trees_are_species_in_the_order_of_their_files() -> None:
    four = {"mesh": " ".join(["asset:a"] * 4), "birch": 1.0}
    assert list(listed(four)) == ["tree 1", "tree 2", "tree 3", "tree 4"]
    assert bands_of([3, 4, 5, 6], four) == [0, 1, 2, 3]
    with pytest.raises(InputError, match="at most 4") as refused:
        bands_of([3, 4, 5, 6, 7], {"mesh": " ".join(["asset:a"] * 5)})
    assert refused.value.field == "canopy.mesh"


def test_each_species_alone_is_a_stand_thinned_evenly() -> None:
    arguments = {"broadleaf": 0.0, "conifer": 1.0, "birch": 1.0, "seed": 1}
    meshes, weights, kinds = nursery(arguments)
    trees = banded(plant(meshes, kinds, weights, 1.0, 1, NEARNESS), bands_of(kinds, arguments))
    area = (RHOMBI * TILE_SIDE) ** 2 * np.sqrt(0.75)
    assert {tree.rank // BAND_RANKS for tree in trees} == {1, 2}, "conifer and birch, second and third of the list"
    for band in (1, 2):
        own = [tree for tree in trees if tree.rank // BAND_RANKS == band]
        assert len({tree.kind for tree in own}) == 1
        crowns = sum(len(tree.cells) * np.pi * tree.spread**2 for tree in own) / area
        assert crowns == pytest.approx(0.54, abs=0.04), "of 0.73 planted alone, and 0.36 in a mixture"
        count = np.bincount([tree.rank % BAND_RANKS for tree in own], minlength=BAND_RANKS)
        assert count.max() <= count.min() + 1
        # An atlas is no plane: trees of one rhombus, away from its edges, are surely each other's neighbours.
        inner = [tree for tree in own if len(tree.cells) == 1]
        feet = np.array([tree.foot + 1e3 * tree.cells[0] for tree in inner])
        crown = np.array([tree.spread for tree in inner])
        apart = np.hypot(*(feet[:, None] - feet[None]).transpose(2, 0, 1)) + 1e3 * np.eye(len(feet))
        assert (apart > SPACING * (crown[:, None] + crown[None]) - 1e-9).all()


def stand_error(ask: Callable[..., Any]) -> float:
    """Share of places where the shader's trees differ from those that the map and the share have at their foot."""
    species = RNG.integers(0, BANDS + 1, (PRESENCE_SIDE, PRESENCE_SIDE)).astype(np.uint8)
    terrain = worlds.ground() | {"species": species, "sections": np.arange(BANDS + 1, dtype=np.uint8),
                                 "presence": np.full((PRESENCE_SIDE, PRESENCE_SIDE), 128, np.uint8)}
    xy = RNG.uniform(-2000, 2000, (4000, 2)).astype(np.float32)
    byte, wood = RNG.integers(0, 128, 4000), RNG.integers(0, 2, 4000)
    east, north = RNG.integers(0, 256, (2, 4000))
    voxel = np.stack([0 * byte, 0 * byte, east * 256 + north, 7 * 256 + byte + 128 * wood], axis=1)
    found = ask([], "stand_of(xy, voxel)", {"xy": xy, "voxel": voxel}, 2, terrain=terrain)[:, 0]
    foot = xy.astype(float) + (np.stack([east, north], axis=1) - 128) / 16
    place = np.stack([SIDE / 2 - foot[:, 1], SIDE / 2 + foot[:, 0]], axis=1) / SIDE * PRESENCE_SIDE
    clear = (np.abs(place - np.rint(place)) > 1e-3).all(axis=1)
    there = species[tuple(place.astype(int).T)]
    exact = ((there == 0) | (there == byte // 32 + 1)) & (byte % 32 <= 16)
    return float((found != exact)[clear].mean())


def test_a_tree_stands_where_the_map_has_its_species_at_its_foot(ask: Callable[..., Any]) -> None:
    assert stand_error(ask) == 0


@pytest.mark.parametrize(("right", "wrong"), [
    ("rank_of(foot, two_bytes(voxel.w).y)", "rank_of(xy, two_bytes(voxel.w).y)"),
    ("textureLod(species, terrain_coordinate(foot), 0.0)", "textureLod(species, terrain_coordinate(foot.yx), 0.0)"),
    ("textureLod(species, terrain_coordinate(foot), 0.0)", "textureLod(species, terrain_coordinate(foot + 4.0), 0.0)"),
    ("floor(rank * 4.0) + 1.0", "floor(rank * 4.0)"),
    ("fract(rank * 4.0)", "rank"),
])
def test_a_wrong_lookup_is_found(ask: Callable[..., Any], spoil: Callable, right: str, wrong: str) -> None:
    with spoil("forest/world.glsl", right, wrong):
        assert stand_error(ask) > 0.03


# A slab of species 2, on land of which a map gives it the west: what does not stand hides no sun.

FILE = "forest/shadow/sun_march.glsl"


def sun_error(ask: Callable[..., Any]) -> float:
    """Greatest error of the mean share of the sun, where the slab's trees stand and where they do not."""
    species = np.full((PRESENCE_SIDE, PRESENCE_SIDE), 3, np.uint8)
    species[:, : PRESENCE_SIDE // 2] = 2
    terrain = worlds.ground() | {"species": species, "sections": SECTIONS}
    pattern = worlds.uniform(6)
    for name in [name for name in pattern if name.startswith("anchor")]:
        pattern[name][..., 3] = BAND_RANKS + 5
    state = worlds.state(sun=worlds.sun(0, 40))
    tops = bake_stand_tops({}, {"terrain": terrain, "pattern": pattern}, lambda share, words: None)["tops"]
    bounds = shadow_bounds(terrain, tops, angles(state.sun))
    y, above = RNG.uniform(-300, 300, 2000), 6.0
    errors = []
    for east, depth in ((-500.0, -np.log1p(-6 / 255) * (20 - above) / np.sin(np.radians(40)) / VOXEL), (500.0, 0.0)):
        places = np.column_stack([np.full(2000, east), y, np.full(2000, above)])
        found = ask([FILE], "shadow_visibility(position, h, vec2(0.0))", {"position": places, "h": places[:, 2] / 20},
                    state=state, terrain=terrain, pattern=pattern, values={"sample_shift": 0.0},
                    techniques={"shadow": SunMarch(step=1.0)}, textures={"shadow_land": bounds})[:, 0]
        errors.append(abs(float(found.mean()) - np.exp(-depth)))
    return max(errors)


def test_the_sun_passes_what_does_not_stand(ask: Callable[..., Any]) -> None:
    assert sun_error(ask) < 0.01


def test_a_sun_that_meets_every_species_is_found(ask: Callable[..., Any], spoil: Callable) -> None:
    """As it was once: the trees that the map leaves out shaded those that stand."""
    with spoil(FILE, "rank_of(p.xy + away, voxel.w)", "mod(voxel.w, 128.0) / 128.0"):
        assert sun_error(ask) > 0.3


# The grove of two species, and a map that has the one in the west and the other in the east.

SHOWN, POSITIONS, TURNS = 32, 4, 16
SECTIONS = np.array([0, 0, 1, 2, 0], np.uint8)
MAPPED = worlds.merged({**SCENE, **worlds.with_technique("shadow", "sun_march")},
                       {"cover": {"species_map": NO_FILE}, "canopy": {"broadleaf": 0.0}})


def half(shift: int = 0) -> np.ndarray:
    """Species 2 to the west of the place that is `shift` pixels east of the middle, 3 beyond."""
    made = np.full((PRESENCE_SIDE, PRESENCE_SIDE), 2, np.uint8)
    made[:, PRESENCE_SIDE // 2 + 4 + shift :] = 3
    return made


@pytest.fixture(scope="module")
def pattern() -> dict[str, np.ndarray]:
    """The grove, its trees of species 2, darker, and 3 by the atlas' rhombi."""
    made = dict(_baked(worlds.GROVE_PATTERN).arrays)
    colour, anchor = made["colour"].copy(), made["anchor"].copy()
    cell = np.arange(colour.shape[2]) * RHOMBI // colour.shape[2]
    second = (cell[:, None] + cell[None]) % 2
    anchor[..., 3] = anchor[..., 3] // 128 * 128 + (1 + second) * BAND_RANKS
    colour[..., :3] = np.where(second[..., None], colour[..., :3], colour[..., :3] // 4)
    return made | {"colour": colour, "anchor": anchor}


def bakes(pattern: dict[str, np.ndarray], species: np.ndarray) -> Any:
    ground = dict(_baked(worlds.GROVE_GROUND).arrays) | {"species": species, "sections": SECTIONS}
    tops = bake_stand_tops({}, {"terrain": ground, "pattern": pattern}, lambda share, words: None)
    return worlds.together(sky=worlds.sky(SKY), pattern=pattern, terrain=ground, stand_tops=tops)


def drawn(thread: Any, painter: view.Painter, baked: Any) -> np.ndarray:
    found = view.paint(thread, painter, MAPPED, baked, (SHOWN, SHOWN), POSITIONS * TURNS,
                       place=lambda sample: offset(sample % POSITIONS))
    return found.linear[..., :3].astype(np.float64)


def test_a_map_is_drawn_as_the_reference_has_it(
    thread: Any, painter: view.Painter, pattern: Any, spoil: Callable
) -> None:
    """Trees and their shadows: as near as one species is, with the trees that the map chooses and with no others."""
    baked = bakes(pattern, half())
    arrays = {name: entry.arrays for name, entry in baked.items()}
    world = replace(ForestWorld(**world_arrays(MAPPED, arrays)), background=None)
    truth = render(world, lambda place: rays(MAPPED.camera, SHOWN, SHOWN, place), offsets(POSITIONS),
                   REFERENCE_OPTIONS["full"]).radiance[..., :3]
    assert relative_rmse(drawn(thread, painter, baked), truth) < BUDGET
    for wrong in (half(3), half()[:, ::-1], 5 - half()):
        assert relative_rmse(drawn(thread, painter, bakes(pattern, wrong)), truth) > 1.5 * BUDGET
    with spoil(FILE, "rank_of(p.xy + away, voxel.w)", "mod(voxel.w, 128.0) / 128.0"):
        assert relative_rmse(drawn(thread, painter, baked), truth) > 1.5 * BUDGET
