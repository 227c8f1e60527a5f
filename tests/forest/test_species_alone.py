"""Sections: each canopy is baked as if the others were never planted, and read where it stands."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.ndimage import map_coordinates

from renderer.core.technique import Arrays
from renderer.forest.canopy_horizon import bake_canopy_horizon
from renderer.forest.horizon_textures import canopy_at, stacked_at
from renderer.forest.pattern import _seen
from renderer.forest.pattern_kernels import extend
from renderer.forest.pattern_mips import mips
from renderer.forest.planting import BAND_RANKS, mixed_share
from renderer.forest.safe_distance import safe_distance
from renderer.forest.seen_levels import seen_levels
from renderer.forest.soft_horizon import bake_soft_horizon
from renderer.forest.species_alone import of_owner, opacities, sections
from renderer.forest.tiles import lattice
from renderer.forest.transmittance import at_sun, bake_transmittance
from renderer.forest.visible_sky import bake_canopy_sky
from renderer.forest.world_scale import PRESENCE_SIDE, VOXEL
from tests.forest import worlds

Ask = Callable[..., np.ndarray]
BANDS = np.array([1, 3], np.uint8)
RNG = np.random.default_rng(6)


def silent(*told: Any) -> None:
    """Nobody is told of progress."""


@pytest.fixture(scope="module")
def mixed() -> dict[str, np.ndarray]:
    """A small atlas in which trees of two species stand in one another, columns of 4 x 4 voxels each."""
    shape = (32, 32, 32)
    band, rank = (np.kron(RNG.integers(0, n, (8, 8)), np.ones((4, 4), int)) for n in (2, BAND_RANKS))
    colour = np.zeros((*shape, 4), np.uint8)
    colour[..., 3] = RNG.integers(1, 120, shape) * (RNG.random(shape) < 0.3)
    colour[24:, ..., 3] = 0
    colour[..., :3] = colour[..., 3:] // np.array([2, 3, 4])
    anchor = np.full((*shape, 4), 128, np.uint8)
    anchor[..., 2] = safe_distance(colour[..., 3] > 0)
    anchor[..., 3] = BANDS[band] * BAND_RANKS + rank
    return {"colour": colour, "anchor": anchor, "normal": np.full((*shape, 4), 128, np.uint8), "bands": BANDS}


def felled(pattern: Arrays, stand: np.ndarray) -> dict[str, np.ndarray]:
    """A pattern without a map, in which only some trees were ever planted."""
    colour, anchor = np.where(stand[..., None], pattern["colour"], np.uint8(0)), pattern["anchor"].copy()
    full = colour[..., 3] > 0
    extend(full, np.zeros((*full.shape, 3), np.float32), anchor, lattice(VOXEL))
    anchor[..., 2] = safe_distance(full)
    level = {"colour": colour, "anchor": anchor, "normal": pattern["normal"]}
    return {**level, "colour_1": mips(level)[0]["colour"]}


def test_a_section_is_one_species_or_the_mixture_thinned(mixed: Arrays) -> None:
    found = sections(mixed["anchor"], BANDS)
    band, rank = np.divmod(mixed["anchor"][..., 3], BAND_RANKS)
    assert len(found) == 3
    np.testing.assert_array_equal(found[0], rank / BAND_RANKS < mixed_share(2))
    assert 0.5 < found[0].mean() < 0.8
    for number, one in enumerate(BANDS, start=1):
        np.testing.assert_array_equal(found[number], band == one)


def test_a_section_is_baked_as_if_nothing_else_were_planted(mixed: Arrays) -> None:
    alone = [felled(mixed, stand) for stand in sections(mixed["anchor"], BANDS)]
    sun = 0.7, np.radians([12.0, 30.0, 50.0])
    bakes: list[Callable[[Arrays], np.ndarray]] = [
        lambda p: bake_canopy_horizon({"sectors": 4, "heights": [0.7, 0.3]}, {"pattern": p}, silent)["sectors"],
        lambda p: np.moveaxis(bake_soft_horizon({"sectors": 2, "heights": [0.0, 0.4]}, {"pattern": p}, silent)["soft"],
                              1, 0),
        lambda p: bake_canopy_sky({}, {"pattern": p}, silent)["seen"],
        lambda p: at_sun(bake_transmittance({"coefficients": 8}, {"pattern": p}, silent), *sun),
        lambda p: opacities(p, 1)[0] if "bands" not in p else np.concatenate(opacities(p, 1)),
    ]
    for bake in bakes:
        together, each = bake(mixed), [bake(one) for one in alone]
        np.testing.assert_array_equal(together, np.concatenate(each))
        assert (each[1] != each[2]).mean() > 0.05, "the species are alike"


def test_coarser_levels_of_a_section_hold_nothing_else(mixed: Arrays) -> None:
    """A far stand of one species has its colour and its matter, not that of what does not stand there."""
    axes = lattice(VOXEL)
    each = [seen_levels(felled(mixed, stand), axes, VOXEL, silent) for stand in sections(mixed["anchor"], BANDS)]
    found = _seen(mixed, BANDS, silent)
    for level in range(1, 6):
        np.testing.assert_array_equal(found[f"seen_{level}"], np.concatenate([one[f"seen_{level}"] for one in each]))
        of_last = found[f"seen_{level}"][64:]
        assert (of_last[..., 7] // BAND_RANKS == 3)[of_last[..., 3] > 0].all()


def test_light_comes_past_the_own_species_alone(mixed: Arrays) -> None:
    """At the finest level a voxel has what is found where its own species stands."""
    matter = mixed["colour"][..., 3].astype(float)
    told: list[float] = []

    def found(stand: np.ndarray, tell: Callable[[float], None]) -> np.ndarray:
        tell(1.0)
        return np.broadcast_to((matter * stand).sum(axis=0), matter.shape)

    own = of_owner(mixed["anchor"], BANDS, found, told.append)
    for stand in sections(mixed["anchor"], BANDS)[1:]:
        np.testing.assert_array_equal(own[stand], found(stand, told.append)[stand])
    assert told[:2] == pytest.approx([1 / 2, 1])
    np.testing.assert_array_equal(of_owner(mixed["anchor"], None, found, told.append)[0], matter.sum(axis=0))


# Where the shader reads them: against numpy, in a map of random species.

PLACES = 2000
XY = RNG.uniform(-2000, 2000, (PLACES, 2)).astype(np.float32)
UV, H = RNG.uniform(0, 1, (PLACES, 2)).astype(np.float32), RNG.uniform(0, 1, PLACES).astype(np.float32)


def land() -> dict[str, np.ndarray]:
    species = RNG.choice(np.array([0, 2, 4], np.uint8), (PRESENCE_SIDE, PRESENCE_SIDE))
    return worlds.ground() | {"species": species, "sections": np.array([0, 0, 1, 0, 2], np.uint8)}


LAND = land()


def section_there() -> np.ndarray:
    place = np.stack([2048 - XY[:, 1], 2048 + XY[:, 0]], axis=1).astype(float) / 4096 * PRESENCE_SIDE
    return LAND["sections"][LAND["species"][tuple(place.astype(int).T)]].astype(int)


def filtered(volume: np.ndarray, k: np.ndarray) -> np.ndarray:
    """Trilinear values of a volume (K, J, I) at the places, round its sides; the middle of layer k is k."""
    wrapped = np.pad(volume, ((0, 0), (1, 1), (1, 1)), mode="wrap")
    size = volume.shape[1]
    return map_coordinates(wrapped, [np.clip(k, 0, len(volume) - 1), UV[:, 1] * size + 0.5, UV[:, 0] * size + 0.5],
                           order=1)


def share_off(found: np.ndarray, exact: np.ndarray) -> float:
    return float((np.abs(found - exact) > 0.02).mean())


def map_error(ask: Ask) -> float:
    maps = RNG.random((3, 16, 16)).astype(np.float32)
    held = canopy_at(np.repeat(maps[:, None], 4, axis=1), 0.3, 1)
    assert held.shape == (3 * 18, 16)
    found = ask([], "textureLod(held, stacked(uv, xy, vec2(textureSize(held, 0))), 0.0).r", {"xy": XY, "uv": UV},
                terrain=LAND, textures={"held": held}, declarations="uniform sampler2D held;")[:, 0]
    each = np.stack([filtered(one[None], np.zeros(PLACES)) for one in maps])
    return share_off(found, each[section_there(), np.arange(PLACES)])


def layer_error(ask: Ask) -> float:
    volumes = RNG.integers(0, 256, (3, 4, 16, 16, 4)).astype(np.uint8)
    body = "textureLod(held, layered(vec3(uv, h), xy, float(textureSize(held, 0).z)), 0.0).r"
    found = ask([], body, {"xy": XY, "uv": UV, "h": H}, terrain=LAND, textures={"held": volumes.reshape(12, 16, 16, 4)},
                declarations="uniform sampler3D held;")[:, 0]
    each = np.stack([filtered(one[..., 0] / 255, H * 4 - 0.5) for one in volumes])
    return share_off(found, each[section_there(), np.arange(PLACES)])


def voxel_error(ask: Ask) -> float:
    pattern = worlds.uniform(9)
    seen = RNG.integers(0, 256, (96, 16, 16, 8)).astype(np.uint8)
    coarser = {f"seen_{n}": seen[:, : 32 >> n, : 32 >> n] for n in range(1, 6)}
    body = "vec4 v = voxel_at(xy, vec3(uv, h), 1.0); result[0] = two_bytes(v.x).x; result[1] = opacity_of(v);"
    found = ask([], body, {"xy": XY, "uv": UV, "h": H}, 2, terrain=LAND, pattern={**pattern, **coarser, "bands": BANDS})
    k, j, i = np.floor(H * 32).astype(int), *(np.floor(UV.T[::-1] * 16).astype(int))
    exact = seen[section_there() * 32 + k, j, i].astype(float)
    off = (found[:, 0] != exact[:, 0]) | (np.abs(found[:, 1] - np.minimum(exact[:, 3] / 255, 1 - 2**-12)) > 1e-4)
    return float(off.mean())


@pytest.mark.parametrize("error", [map_error, layer_error, voxel_error])
def test_a_place_reads_the_canopy_that_stands_there(ask: Ask, error: Callable[[Ask], float]) -> None:
    assert error(ask) < 0.005  # roundings where the map's pixels, or a volume's voxels, meet


@pytest.mark.parametrize(("error", "right", "wrong"), [
    (map_error, "rows + 1.0 + fract", "rows + fract"),
    (map_error, "coordinate(xy), 0.0).g * 255.0", "coordinate(xy), 0.0).r * 255.0"),
    (layer_error, "clamp(place.z, half_layer, 1.0 - half_layer)", "place.z"),
    (voxel_error, "section_at(xy) * layers + clamp", "clamp"),
    (voxel_error, "max(level - 1.0, 0.0)", "level"),
])
def test_the_wrong_canopy_is_found(ask: Ask, spoil: Callable, error: Callable, right: str, wrong: str) -> None:
    with spoil("forest/world.glsl", right, wrong):
        assert error(ask) > 0.03


def test_heights_of_a_section_follow_those_of_the_one_before() -> None:
    """The horizon volume counts its heights on through the sections."""
    soft = RNG.integers(0, 256, (4, 6, 8, 8, 3)).astype(np.uint8)
    whole = stacked_at(soft, 0.2)
    np.testing.assert_array_equal(whole[30:], stacked_at(soft[:, 3:], 0.2))
