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
from renderer.forest.nursery import bands_of, listed, nursery
from renderer.forest.planting import BAND_RANKS, BANDS, NEARNESS, SPACING, banded, plant
from renderer.forest.program import trace_source
from renderer.forest.seen_levels import seen_levels
from renderer.forest.species_alone import each_alone
from renderer.forest.stand_maps import mixed_share, species_map
from renderer.forest.tiles import RHOMBI, lattice
from renderer.forest.world_arrays import world_arrays
from renderer.forest.world_scale import CELL, NODES, PRESENCE_SIDE, TILE_SIDE
from renderer.reference.forest import render
from renderer.reference.forest_world import ForestWorld
from renderer.study.metrics import relative_rmse
from renderer.world.camera import rays
from renderer.world.sampling import offset, offsets
from tests.forest import worlds
from tests.forest.truth import MARCH, REFERENCE_OPTIONS, SCENE, SKY

SIDE = NODES * CELL
RULES: dict[str, Any] = worlds.state().cover.model_dump(mode="json")
BUILT_IN = worlds.state().terrain.model_dump(mode="json")
LISTED = {"broadleaf": False, "conifer": True, "birch": True}
NO_FILE = "asset:" + "0" * 64
RNG = np.random.default_rng(5)


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
    made = bake_ground({"terrain": BUILT_IN, "cover": rules, "species": LISTED}, {}, lambda share, words: None)
    inner = made["presence"][4 * RIM : -4 * RIM]
    assert (inner[:, PRESENCE_SIDE // 2 : -4 * RIM] == 255).all()
    assert (inner[:, 4 * RIM : PRESENCE_SIDE // 2] == round(255 * mixed_share(LISTED))).all()


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
    assert "banded" not in pattern_bake(plain).arguments
    assert "species" not in ground_bake(plain).arguments
    assert pattern_bake(mapped).arguments["banded"]
    assert ground_bake(mapped).arguments["species"] == {"broadleaf": True, "conifer": True, "birch": False}
    assert "#define SPECIES_MAP 0" in trace_source(plain).text
    assert "#define SPECIES_MAP 1" in trace_source(mapped).text


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



def test_coarser_levels_keep_the_species_apart() -> None:
    """A far stand of one species has its colour, not that of what does not stand there."""
    shape = (4, 32, 32)
    band = RNG.integers(0, 2, shape[1:])
    colour = np.zeros((*shape, 4), np.uint8)
    colour[..., 3] = 4  # so thin that no species darkens another
    colour[..., 0], colour[..., 1] = np.where(band, 4, 0), np.where(band, 0, 4)
    anchor = np.full((*shape, 4), 128, np.uint8)
    anchor[..., 3] = band * BAND_RANKS
    given = {"colour": colour, "anchor": anchor}
    axes = lattice(0.625)
    kept_apart = seen_levels(given, axes, 0.625, lambda share: None, BAND_RANKS)
    together = seen_levels(given, axes, 0.625, lambda share: None)
    for level in (1, 3, 5):
        seen = kept_apart[f"seen_{level}"]
        own = seen[..., 7] // BAND_RANKS
        np.testing.assert_array_equal(seen[..., 0], np.where(own, 255, 0))
        np.testing.assert_array_equal(seen[..., 1], np.where(own, 0, 255))
        opaque = seen[..., 3].mean() / together[f"seen_{level}"][..., 3].mean()
        assert opaque == pytest.approx(1, abs=0.02), "the block's owner stands for all its matter"
    assert set(np.unique(kept_apart["seen_1"][..., 7])) == {0, BAND_RANKS}


def test_light_comes_past_the_own_species_alone() -> None:
    """What is found of a voxel is found where the other species' trees are felled; air goes with the first."""
    owner = RNG.integers(1, 4, (3, 8, 8))
    full = RNG.random(owner.shape) < 0.5
    matter = RNG.random(owner.shape) * full
    told: list[float] = []

    def found(own: np.ndarray, tell: Callable[[float], None]) -> np.ndarray:
        tell(1.0)
        return np.stack([np.broadcast_to((matter * own).sum(axis=0), owner.shape), own], axis=-1)

    owner[0][~full[0]] = 0  # a band of which nothing stands
    light = each_alone(owner, full, found, told.append)
    for band in (1, 2, 3):
        sums = (matter * (owner == band)).sum(axis=0)
        at = np.nonzero(owner == band)
        np.testing.assert_array_equal(light[at][:, 0], sums[at[1:]])
        assert light[at][:, 1].all()
    assert told == pytest.approx([1 / 3, 2 / 3, 1])
    plain = each_alone(0 * owner, full, found, told.append)
    np.testing.assert_array_equal(plain[..., 0], np.broadcast_to(matter.sum(axis=0), owner.shape))


def stand_error(ask: Callable[..., Any]) -> float:
    """Share of places where the shader's trees differ from those that the map and the share have at their foot."""
    species = RNG.integers(0, BANDS + 1, (PRESENCE_SIDE, PRESENCE_SIDE)).astype(np.uint8)
    terrain = worlds.ground() | {"species": species,
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
    ("textureLod(species, terrain_coordinate(foot), 0.0)", "textureLod(species, terrain_coordinate(xy), 0.0)"),
    ("textureLod(species, terrain_coordinate(foot), 0.0)", "textureLod(species, terrain_coordinate(foot.yx), 0.0)"),
    ("textureLod(species, terrain_coordinate(foot), 0.0)", "textureLod(species, terrain_coordinate(foot + 4.0), 0.0)"),
    ("floor(rank * 4.0) + 1.0", "floor(rank * 4.0)"),
    ("fract(rank * 4.0)", "rank"),
])
def test_a_wrong_lookup_is_found(ask: Callable[..., Any], spoil: Callable, right: str, wrong: str) -> None:
    with spoil("forest/world.glsl", right, wrong):
        assert stand_error(ask) > 0.03


# The grove of two species, and a map that has the one in the west and the other in the east.

SHOWN, POSITIONS, TURNS = 40, 4, 16
MAPPED = worlds.merged({**SCENE, **worlds.PLAIN}, {"cover": {"species_map": NO_FILE}})


def half(shift: int = 0) -> np.ndarray:
    """Species 1 to the west of the place that is `shift` pixels east of the middle, 2 beyond."""
    made = np.ones((PRESENCE_SIDE, PRESENCE_SIDE), np.uint8)
    made[:, PRESENCE_SIDE // 2 + 4 + shift :] = 2
    return made


def two_species() -> dict[str, np.ndarray]:
    """The grove, its trees of species 1, darker, and 2 by the atlas' rhombi."""
    pattern = dict(worlds.grove_pattern({}, {}, lambda share, words: None))
    colour, anchor = pattern["colour"].copy(), pattern["anchor"].copy()
    cell = np.arange(colour.shape[2]) * RHOMBI // colour.shape[2]
    second = (cell[:, None] + cell[None]) % 2
    anchor[..., 3] = anchor[..., 3] // 128 * 128 + second * BAND_RANKS
    colour[..., :3] = np.where(second[..., None], colour[..., :3], colour[..., :3] // 4)
    pattern |= {"colour": colour, "anchor": anchor}
    return {**pattern, **seen_levels(pattern, lattice(0.625), 0.625, lambda share: None, BAND_RANKS)}


def bakes(pattern: dict[str, np.ndarray], species: np.ndarray | None) -> Any:
    ground = dict(worlds.grove_ground({}, {}, lambda share, words: None))
    return worlds.together(sky=worlds.sky(SKY), pattern=pattern,
                           terrain=ground if species is None else ground | {"species": species})


def drawn(thread: Any, painter: view.Painter, state: Any, baked: Any, turns: int = TURNS) -> np.ndarray:
    found = view.paint(thread, painter, state, baked, (SHOWN, SHOWN), POSITIONS * turns,
                       place=lambda sample: offset(sample % POSITIONS))
    return found.linear.astype(np.float64)


def felled(pattern: dict[str, np.ndarray], alone: int) -> dict[str, np.ndarray]:
    """The pattern with the trees of one species, all of the first rank, and no others."""
    colour, anchor = pattern["colour"].copy(), pattern["anchor"].copy()
    colour[anchor[..., 3] % 128 // BAND_RANKS + 1 != alone] = 0
    anchor[..., 3] = anchor[..., 3] // 128 * 128
    return pattern | {"colour": colour, "anchor": anchor}


def true(baked: Any) -> np.ndarray:
    """The reference's picture (SHOWN, SHOWN, 3), without shadows."""
    arrays = {name: entry.arrays for name, entry in baked.items()}
    world = replace(ForestWorld(**world_arrays(MAPPED, arrays)), background=None)
    found = render(world, lambda place: rays(MAPPED.camera, SHOWN, SHOWN, place), offsets(POSITIONS),
                   REFERENCE_OPTIONS["unshadowed"])
    return found.radiance[..., :3]


@pytest.mark.parametrize("alone", [1, 2])
def test_a_map_of_one_species_shows_its_trees_and_no_others(thread: Any, painter: view.Painter, alone: int) -> None:
    pattern = two_species()
    species = np.full((8, 8), alone, np.uint8)
    mapped = drawn(thread, painter, MAPPED, bakes(pattern, species), 1)
    plain, alike = worlds.state(**{**SCENE, **worlds.PLAIN}), bakes(felled(pattern, alone), None)
    np.testing.assert_array_equal(mapped, drawn(thread, painter, plain, alike, 1))
    assert np.ptp(mapped[..., 0]) > 0.05
    # the reference skips air by steps of its own, which the felled trees lengthen
    assert relative_rmse(true(bakes(pattern, species)), true(alike)) < 0.005


def test_a_map_is_drawn_as_the_reference_has_it(thread: Any, painter: view.Painter) -> None:
    pattern = two_species()
    baked = bakes(pattern, half())
    truth = true(baked)
    assert relative_rmse(drawn(thread, painter, MAPPED, baked)[..., :3], truth) < 1.5 * MARCH
    for wrong in (half(3), half()[:, ::-1], 3 - half()):
        assert relative_rmse(drawn(thread, painter, MAPPED, bakes(pattern, wrong))[..., :3], truth) > 3 * MARCH
