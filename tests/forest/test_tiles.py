"""Tiles: the packing holds every triple, the hash is the published one, and neighbours agree on the edge they share."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.forest.tiles import BOTTOM, DIAGONAL, EDGES, LEFT, RHOMBI, cell_hash, lattice, locate, tile_table, triple

SIDE = 40.0


def occurrences(edges: np.ndarray) -> list[list[int]]:
    """How often each triple occurs among the upward and the downward triangles, counted by hand."""
    counts = [[0] * 8 for _ in range(2)]
    for p in range(4):
        for q in range(4):
            h, v, d = edges[:, p, q]
            counts[0][h + 2 * v + 4 * d] += 1
            counts[1][edges[0, p, (q + 1) % 4] + 2 * edges[1, (p + 1) % 4, q] + 4 * d] += 1
    return counts


def test_every_triple_has_two_tiles_of_each_orientation():
    assert occurrences(EDGES.astype(int)) == [[2] * 8] * 2


def test_a_spoiled_packing_is_noticed():
    spoiled = EDGES.astype(int)
    spoiled[LEFT, 2, 1] ^= 1
    assert occurrences(spoiled) != [[2] * 8] * 2


def test_table_leads_to_a_triangle_with_the_wanted_edges():
    table = tile_table()
    seen = set()
    for down in (0, 1):
        for variant in (0, 1):
            for key in range(8):
                p, q = (int(x) for x in table[down, variant, key])
                bottom, left, diagonal = (int(x) for x in triple(p, q, down))
                assert bottom + 2 * left + 4 * diagonal == key
                seen.add((down, p, q))
    assert len(seen) == 2 * RHOMBI**2


def test_hash_is_lowbias32_in_plain_whole_numbers():
    def plain(i: int, j: int, d: int, seed: int) -> int:
        m = 0xFFFFFFFF
        x = (i * 0x8DA6B343 & m) ^ (j * 0xD8163841 & m) ^ (d * 0xCB1AB31F & m) ^ (seed * 0x165667B1 & m)
        x = (x ^ x >> 16) * 0x7FEB352D & m
        x = (x ^ x >> 15) * 0x846CA68B & m
        return x ^ x >> 16

    rng = np.random.default_rng(5)
    i, j = rng.integers(-(2**31), 2**31, (2, 300))
    for purpose in range(5):
        expected = [plain(int(a), int(b), purpose, 77) for a, b in zip(i, j, strict=True)]
        assert cell_hash(i, j, purpose, 77).tolist() == expected


def test_triangles_and_coordinates_where_they_are_known():
    e1, e2 = lattice(SIDE)
    up, down = 3 * e1 - 2 * e2 + (e1 + e2) / 4, 3 * e1 - 2 * e2 + 3 * (e1 + e2) / 4
    place = locate(np.array([up, down]), SIDE, seed=9)
    assert place.i.tolist() == [3, 3]
    assert place.j.tolist() == [-2, -2]
    assert place.down.tolist() == [0, 1]
    np.testing.assert_allclose((place.u * 4) % 1, [0.25, 0.75], atol=1e-12)
    np.testing.assert_allclose((place.v * 4) % 1, [0.25, 0.75], atol=1e-12)


@pytest.mark.parametrize(
    ("direction", "along", "across"),
    [
        (BOTTOM, (1, 0), (0, 1)),
        (LEFT, (0, 1), (1, 0)),
        (DIAGONAL, (-1, 1), (1, 1)),
    ],
)
def test_neighbours_agree_on_the_colour_of_their_edge_and_on_the_place_along_it(direction, along, across):
    """Across every edge the atlas shows what surrounds an edge of that direction and colour, at the same place."""
    rng = np.random.default_rng(3)
    start = rng.integers(-40, 40, (500, 2)) + (np.array([1, 0]) if direction == DIAGONAL else 0)
    uv = start + rng.uniform(0.05, 0.95, (500, 1)) * np.array(along)
    sides = [locate((uv + sign * 1e-7 * np.array(across)) @ lattice(SIDE), SIDE, 4) for sign in (1, -1)]
    colours = [place.key >> direction & 1 for place in sides]
    assert (colours[0] == colours[1]).all()
    assert len(np.unique(colours[0])) == 2
    for place, colour in zip(sides, colours, strict=True):
        u, v = place.u * RHOMBI, place.v * RHOMBI
        # The rhombus that owns the edge: that below a point which lies just beyond its top or right side.
        p = np.round(u).astype(int) if direction == LEFT else np.floor(u).astype(int)
        q = np.round(v).astype(int) if direction == BOTTOM else np.floor(v).astype(int)
        assert (EDGES[direction, p % RHOMBI, q % RHOMBI] == colour).all()
    for name in ("u", "v"):
        apart = (getattr(sides[0], name) - getattr(sides[1], name)) * RHOMBI % 1
        assert np.minimum(apart, 1 - apart).max() < 1e-6


def test_the_map_repeats_under_no_small_translation():
    e1, e2 = lattice(SIDE)
    i, j = np.meshgrid(np.arange(60), np.arange(60), indexing="ij")
    centres = (i[..., None] + 0.3) * e1 + (j[..., None] + 0.3) * e2
    place = locate(centres, SIDE, seed=0)
    tile = place.key + 8 * place.variant
    assert (np.bincount(tile.ravel(), minlength=16) / tile.size > 0.04).all()
    for di in range(12):
        for dj in range(12):
            if (di, dj) != (0, 0):
                same = (tile[di:, dj:] == tile[: 60 - di, : 60 - dj]).mean()
                # By chance one pair in sixteen is alike; neighbours share an edge and so a few more.
                assert same < 0.2


def test_seeds_make_other_maps():
    points = np.random.default_rng(0).uniform(-1e5, 1e5, (2000, 2))
    first, second = (locate(points, SIDE, seed) for seed in (0, 1))
    assert (first.key != second.key).mean() > 0.8
