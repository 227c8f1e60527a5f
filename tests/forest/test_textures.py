"""What the shaders read of the bakes: heights, cover, tiles and packed voxels, against numpy in float64."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy import ndimage

from renderer.forest.textures import TILE_MAP, bilinear_cells, packed, stand_texture, tile_map
from renderer.forest.tiles import locate
from renderer.forest.world_scale import CANOPY_HEIGHT, CELL, NODES, PRESENCE_CELL, PRESENCE_SIDE, TILE_SIDE
from tests.forest import worlds

Ask = Callable[..., np.ndarray]
RNG = np.random.default_rng(6)
HALF = (NODES - 1) / 2 * CELL


def between(grid: np.ndarray, cell: float, xy: np.ndarray) -> np.ndarray:
    """Twin: a square grid of places (row 0 the northern edge) between them, its edge continued, float64."""
    last, z = len(grid) - 1, grid.astype(np.float64)
    column = np.clip(xy[:, 0] / cell + last / 2, 0, last)
    row = np.clip(last / 2 - xy[:, 1] / cell, 0, last)
    j, i = (np.minimum(place.astype(int), last - 1) for place in (column, row))
    u, v = column - j, row - i
    return (z[i, j] * (1 - u) + z[i, j + 1] * u) * (1 - v) + (z[i + 1, j] * (1 - u) + z[i + 1, j + 1] * u) * v


def rough() -> dict[str, np.ndarray]:
    """Ground without any regularity, up to 300 m high."""
    return worlds.ground(np.random.default_rng(1).uniform(0, 300, (NODES, NODES)))


def height_error(ask: Ask) -> float:
    """Worst error of the ground's height [m], inside the square and a little beyond it."""
    xy = np.concatenate([RNG.uniform(-HALF - 50, HALF + 50, (2000, 2)), [[-HALF, HALF], [HALF, -HALF], [0, 0]]])
    xy = xy.astype(np.float32)
    found = ask([], "ground_height(xy)", {"xy": xy}, terrain=rough())[:, 0]
    return float(np.abs(found - between(rough()["elevation"], CELL, xy.astype(float))).max())


def test_heights_are_bilinear_and_continue_beyond_the_edge(ask: Ask) -> None:
    # 16 bits of a cell's rise, of up to 600 m here; the last cell is left a thousandth of a cell early.
    assert height_error(ask) < 0.6


@pytest.mark.parametrize(("right", "wrong"), [
    ("dot(f, rise.xy) + f.x", "dot(f.yx, rise.xy) + f.x"),
    ("+ f.x * f.y * rise.z", "- f.x * f.y * rise.z"),
])
def test_a_wrong_height_is_found(ask: Ask, spoil: Callable, right: str, wrong: str) -> None:
    with spoil("forest/world.glsl", right, wrong):
        assert height_error(ask) > 10


def test_the_ground_has_its_planes_normal(ask: Ask) -> None:
    x = (np.arange(NODES) - (NODES - 1) / 2) * CELL
    east, north = np.meshgrid(x, -x)
    terrain = worlds.ground(0.3 * east - 0.2 * north)
    found = ask([], "ground_normal(xy)", {"xy": RNG.uniform(-HALF, HALF, (50, 2))}, 3, terrain=terrain)
    np.testing.assert_allclose(found, np.tile(np.array([-0.3, 0.2, 1]) / np.sqrt(1.13), (50, 1)), atol=1e-3)


def test_cells_hold_the_heights_of_their_corners() -> None:
    cells, (relief, rise) = bilinear_cells(np.array([[3.0, 7.0], [1.0, 2.0]], np.float32))  # north: 3 7, south: 1 2
    south_west, *rises = cells[0, 0] / 65535.0
    assert south_west * relief == pytest.approx(1, abs=relief / 65535)
    # east, north, and both: 1 + 1 + 2 + 3 = 7
    assert (np.array(rises) - 32768 / 65535) * 2 * rise == pytest.approx([1, 2, 3], abs=2 * rise / 65535)


def test_the_steepest_rise_stays_a_rise() -> None:
    """It once came round to the deepest fall."""
    for slope in (0.5, -0.5):
        z = np.arange(NODES, dtype=np.float32)[None, :].repeat(NODES, axis=0) * 4 * np.sign(slope)
        cells, (_, rise) = bilinear_cells(z - z.min())
        east = (cells[:, :-1, 1] / 65535 - 32768 / 65535) * 2 * rise
        np.testing.assert_allclose(east, 4 * np.sign(slope), atol=1e-3)


def test_the_default_relief_keeps_a_centimetre() -> None:
    x = np.arange(NODES) * CELL
    z = (350 + 350 * np.sin(x / 300)[None, :] * np.cos(x / 400)[:, None]).astype(np.float32)
    cells, (relief, rise) = bilinear_cells(z)
    height = cells[..., 0] / 65535 * relief
    assert np.abs(height - z[::-1]).max() < 0.01
    assert 2 * rise / 65535 < 0.001


def stand_error(ask: Ask) -> float:
    """Share of places where the shader's trees differ from those whose rank the share at their foot exceeds."""
    share = RNG.integers(0, 256, (PRESENCE_SIDE, PRESENCE_SIDE)).astype(np.uint8)
    share[::3] = 255
    terrain = worlds.ground() | {"presence": share}
    xy = RNG.uniform(-2000, 2000, (4000, 2)).astype(np.float32)
    rank, wood = RNG.integers(0, 128, 4000), RNG.integers(0, 2, 4000)
    voxel = np.stack([0 * rank, 0 * rank, 0 * rank + 128 * 257, 7 * 256 + rank + 128 * wood], axis=1)
    found = ask([], "stand_of(xy, voxel)", {"xy": xy, "voxel": voxel}, 2, terrain=terrain)[:, 0]
    exact = between(share / 255.0, PRESENCE_CELL, xy.astype(float))
    # Eight bits, filtered with eight more; a fifth of them lies this near.
    clear = np.abs(exact - rank / 128) > 0.015
    assert clear.mean() > 0.7
    return float((found[clear] != (exact > rank / 128)[clear]).mean())


def test_trees_stand_where_the_share_exceeds_their_rank(ask: Ask) -> None:
    assert stand_error(ask) == 0


@pytest.mark.parametrize(("right", "wrong"), [
    ("return xy / (terrain_cell * terrain_nodes) + 0.5;",
     "return vec2(xy.x, -xy.y) / (terrain_cell * terrain_nodes) + 0.5;"),
    ("mod(mark, 128.0)", "mark"),
])
def test_a_wrong_stand_is_found(ask: Ask, spoil: Callable, right: str, wrong: str) -> None:
    with spoil("forest/world.glsl", right, wrong):
        assert stand_error(ask) > 0.1


def test_the_next_stand_is_never_nearer_than_said() -> None:
    share = np.zeros((PRESENCE_SIDE, PRESENCE_SIDE), np.uint8)
    share[200, 81] = share[801, 600] = 1
    made = stand_texture(share).astype(float)
    row, column = np.nonzero(share[::-1])
    # Between texels the share and the distance are both filtered: nothing stands farther than a texel from its own.
    places = RNG.uniform(1, PRESENCE_SIDE - 2, (300, 2))
    distance = (np.hypot(places[:, :1] - row, places[:, 1:] - column).min(axis=1) - np.sqrt(2)) * PRESENCE_CELL
    said = ndimage.map_coordinates(made[..., 1], places.T, order=1)
    assert (said <= np.maximum(distance, 0)).all()
    assert said.max() > 100


def local(growth: float) -> dict[str, np.ndarray]:
    """Level ground whose stands are taller to the east."""
    x = np.linspace(-1, 1, NODES, dtype=np.float32)
    return worlds.ground() | {"growth": np.broadcast_to(1 + growth * x, (NODES, NODES)).copy()}


def test_the_layer_is_as_high_as_the_stand(ask: Ask) -> None:
    xy = RNG.uniform(-HALF, HALF, (500, 2)).astype(np.float32)
    found = ask([], "layer_height(xy)", {"xy": xy}, terrain=local(0.5), local=True)[:, 0]
    np.testing.assert_allclose(found, CANOPY_HEIGHT * (1 + 0.5 * xy[:, 0] / HALF), rtol=1e-3)
    assert (ask([], "layer_height(xy)", {"xy": xy}, terrain=local(0.5))[:, 0] == CANOPY_HEIGHT).all()


def test_the_patch_of_tiles_holds_the_square() -> None:
    """The corners' lattice coordinates are at most (1 / side) (x + y / sqrt 3) from the middle."""
    assert HALF / TILE_SIDE * (1 + 1 / np.sqrt(3)) < TILE_MAP / 2


def tile_error(ask: Ask, seed: int = 0) -> float:
    """Share of points whose atlas coordinate differs from the twin's by a tenth of a voxel."""
    xy = RNG.uniform(-2500, 2500, (5000, 2)).astype(np.float32)
    found = ask([], "atlas_coordinate(xy)", {"xy": xy}, 2, state=worlds.state(ground={"map_seed": seed}))
    twin = locate(xy.astype(float), TILE_SIDE, seed)
    off = np.abs(found - np.stack([twin.u, twin.v], axis=1)).max(axis=1) > 0.1 / 256
    return float(off.mean())


@pytest.mark.parametrize("seed", [0, 7, 2**31 - 1])
def test_tiles_are_those_of_the_hash(ask: Ask, seed: int) -> None:
    # Points within float32 of an edge may fall to either side of it.
    assert tile_error(ask, seed) < 1e-3


@pytest.mark.parametrize(("right", "wrong"), [
    ("f.x + f.y < 1.0 ? both.x : both.y", "f.x + f.y < 1.0 ? both.y : both.x"),
    ("vec2(p, tile - 4.0 * p)", "vec2(tile - 4.0 * p, p)"),
    ("xy.x / tile_side - 0.5 * v", "xy.x / tile_side + 0.5 * v"),
])
def test_a_wrong_tile_is_found(ask: Ask, spoil: Callable, right: str, wrong: str) -> None:
    with spoil("forest/world.glsl", right, wrong):
        assert tile_error(ask) > 0.1


def test_another_seed_lays_another_map() -> None:
    assert (tile_map(0) != tile_map(1)).mean() > 0.5


def voxel_pattern() -> dict[str, np.ndarray]:
    made = worlds.uniform(1)
    rng = np.random.default_rng(11)
    for name in ("colour", "anchor"):
        made[name] = rng.integers(0, 256, made[name].shape).astype(np.uint8)
    return made


BODY = """vec4 voxel = voxel_at(vec2(0.0), vec3(uv, h), 0.0);
vec3 albedo = albedo_of(voxel);
vec2 foot = foot_of(vec2(0.0), voxel);
result[0] = albedo.r; result[1] = albedo.g; result[2] = albedo.b; result[3] = opacity_of(voxel);
result[4] = foot.x; result[5] = foot.y; result[6] = free_voxels(voxel);"""


def voxel_error(ask: Ask) -> float:
    """Worst relative error of what the shader reads of random bytes."""
    pattern = voxel_pattern()
    k, j, i = (RNG.integers(0, 32, 1000) for _ in range(3))
    inputs = {"uv": (np.stack([i, j], axis=1) + 0.5) / 32, "h": (k + 0.5) / 32}
    found = ask([], BODY, inputs, 7, pattern=pattern)
    colour, anchor = (pattern[name][k, j, i].astype(float) for name in ("colour", "anchor"))
    exact = np.concatenate([
        np.minimum(np.floor(255 * colour[:, :3] / np.maximum(colour[:, 3:], 1) + 0.5) / 255, 1),
        np.minimum(colour[:, 3:] / 255, 1 - 2.0**-12),
        (anchor[:, :2] - 128) / 16, anchor[:, 2:3]], axis=1)
    return float((np.abs(found - exact) / np.maximum(np.abs(exact), 1)).max())


def test_packed_voxels_give_back_their_bytes(ask: Ask) -> None:
    assert voxel_error(ask) < 1e-5


@pytest.mark.parametrize(("right", "wrong"), [
    ("(two_bytes(voxel.z) - 128.0)", "(two_bytes(voxel.z) - 127.0)"),
    ("return vec2(high, floor(pair - 256.0 * high + 0.5));", "return vec2(floor(pair - 256.0 * high + 0.5), high);"),
])
def test_a_wrong_unpacking_is_found(ask: Ask, spoil: Callable, right: str, wrong: str) -> None:
    with spoil("forest/world.glsl", right, wrong):
        assert voxel_error(ask) > 0.01


def test_two_bytes_share_a_number() -> None:
    colour, anchor = (np.array([[[values]]], np.uint8) for values in ((1, 2, 3, 51), (128, 0, 24, 255)))
    assert packed(colour, anchor)[0, 0, 0].tolist() == [5 * 256 + 10, 15 * 256 + 51, 32768, 24 * 256 + 255]


def test_the_tint_is_the_worlds_own(ask: Ask) -> None:
    foot = RNG.uniform(-300, 300, (500, 2)).astype(np.float32)
    x, y = foot.T.astype(float)
    exact = np.sin(x * 0.37 + 1.3 * np.sin(y * 0.11)) * np.sin(y * 0.41 + 1.7 * np.sin(x * 0.13))
    np.testing.assert_allclose(ask([], "tint_of(foot)", {"foot": foot})[:, 0], exact, atol=2e-4)
