"""Terrain: its frame, its square, its holes, and what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest

from renderer.core.errors import AssetError, LimitError
from renderer.world.limits import Limits
from renderer.world.terrain import (
    DEFAULT_CENTRE,
    Terrain,
    crop,
    default_terrain,
    height_at,
    normal_at,
    normals,
)
from renderer.world.terrain_crs import Crs, metres_per_degree, place
from renderer.world.terrain_grid import checked, fill_holes


def plane(rows: int, columns: int, cell: tuple[float, float], east: float, north: float) -> np.ndarray:
    """Heights of z = 100 + east x + north y, x and y from the centre, row 0 at the north."""
    x = (np.arange(columns) - (columns - 1) / 2) * cell[0]
    y = ((rows - 1) / 2 - np.arange(rows)) * cell[1]
    return (100 + north * y[:, None] + east * x[None, :]).astype(np.float32)


def test_default_terrain_is_the_model_the_references_were_measured_on() -> None:
    terrain = default_terrain()
    assert terrain.elevation.shape == (344, 403)
    assert terrain.cell_size == pytest.approx((74.2660481, 92.6666667), rel=1e-8)
    assert (terrain.elevation.min(), terrain.elevation.max()) == (236, 1076)
    assert terrain.latitude == pytest.approx(36.59, abs=1e-6)
    assert terrain.longitude == pytest.approx(-84.24625, abs=1e-6)


def test_default_square_has_more_relief_and_slope_than_the_median() -> None:
    """The choice by measurement still holds: 364 m and 15.5 degrees are the medians over the whole model."""
    square = crop(default_terrain(), DEFAULT_CENTRE, 4096, 8)
    assert square.elevation.shape == (512, 512)
    assert square.cell_size == (8, 8)
    low, high = np.percentile(square.elevation, [1, 99])
    slope = np.degrees(np.arccos(normals(square.elevation, square.cell_size)[..., 2])).mean()
    assert high - low > 650
    assert slope > 18


def test_crop_follows_a_plane_and_keeps_the_frame() -> None:
    """Cubic splines reproduce a plane; a wrong axis or sign would mirror it."""
    terrain = Terrain(plane(60, 80, (10, 12), 0.3, -0.2), (10.0, 12.0))
    centre = (50.0, -40.0)
    square = crop(terrain, centre, 200, 4)
    offset = (np.arange(50) - 24.5) * 4
    expected = 100 + 0.3 * (centre[0] + offset[None, :]) - 0.2 * (centre[1] - offset[:, None])
    # 1.3 mm: the spline's clamped edge, 16 nodes away at its nearest, and float32 storage.
    np.testing.assert_allclose(square.elevation, expected, atol=2e-3)
    mirrored = 100 + 0.3 * (centre[0] + offset[None, :]) + 0.2 * (centre[1] - offset[:, None])
    assert np.abs(square.elevation - mirrored).max() > 10


def test_crop_at_the_same_cells_returns_the_nodes() -> None:
    rng = np.random.Generator(np.random.PCG64(5))
    terrain = Terrain(rng.uniform(0, 50, (40, 40)).astype(np.float32), (8.0, 8.0))
    np.testing.assert_allclose(crop(terrain, (0, 0), 40 * 8, 8).elevation, terrain.elevation, atol=1e-4)


def test_crop_to_coarser_cells_does_not_alias() -> None:
    """A 1 m comb under 8 m cells must vanish into its mean; picking every eighth node keeps all of it."""
    comb = np.tile(np.array([0.0, 2.0], dtype=np.float32), (256, 128))
    coarse = crop(Terrain(comb, (1.0, 1.0)), (0, 0), 160, 8).elevation
    assert np.abs(coarse - 1).max() < 0.01
    assert np.abs(comb[::8, ::8] - 1).max() == 1


def test_crop_continues_the_edge_and_refuses_a_centre_outside() -> None:
    terrain = Terrain(np.full((10, 10), 7, dtype=np.float32), (10.0, 10.0))
    np.testing.assert_allclose(crop(terrain, (0, 0), 1000, 10).elevation, 7, atol=1e-4)
    with pytest.raises(AssetError, match="centre"):
        crop(terrain, (0, 100), 50, 5)
    with pytest.raises(LimitError, match="cell_size"):
        crop(terrain, (0, 0), 100_000, 1)
    with pytest.raises(AssetError, match="cell_size"):
        crop(terrain, (0, 0), 10, 10)


def test_crop_knows_where_its_corner_lies() -> None:
    terrain = default_terrain()
    square = crop(terrain, (0, 0), 4096, 8)
    assert square.latitude == pytest.approx(36.59, abs=1e-9)
    assert square.crs is not None
    assert (terrain.longitude - square.origin[0]) * square.crs.unit[0] == pytest.approx(511 * 4, rel=1e-6)
    assert (square.origin[1] - terrain.latitude) * square.crs.unit[1] == pytest.approx(511 * 4, rel=1e-6)


def test_crop_refuses_a_number_that_is_none() -> None:
    for centre, side, cell in (((math.nan, 0.0), 100.0, 5.0), ((0.0, 0.0), math.inf, 5.0), ((0.0, 0.0), 100.0, 0.0)):
        with pytest.raises(AssetError, match=r"centre|cell_size|side"):
            crop(default_terrain(), centre, side, cell)


def test_normals_of_a_plane_point_up_its_slope_backwards() -> None:
    cell = (10.0, 12.0)
    elevation = plane(20, 30, cell, 0.3, -0.2)
    expected = np.array([-0.3, 0.2, 1]) / math.sqrt(1 + 0.09 + 0.04)
    np.testing.assert_allclose(normals(elevation, cell), np.broadcast_to(expected, (20, 30, 3)), atol=1e-5)
    x, y = np.array([0.0, 133.0, 9999.0]), np.array([0.0, -77.0, 9999.0])
    np.testing.assert_allclose(normal_at(elevation, cell, x, y), np.broadcast_to(expected, (3, 3)), atol=1e-5)


def test_height_between_nodes_is_bilinear_and_clamped() -> None:
    elevation = np.array([[0, 4], [8, 20]], dtype=np.float32)  # row 0 is the north: y = +1
    x, y = np.array([0.0, -1.0, 1.0, 5.0]), np.array([0.0, 1.0, -1.0, -5.0])
    np.testing.assert_allclose(height_at(elevation, (2.0, 2.0), x, y), [8, 0, 20, 20])


def test_holes_are_refused_where_they_are_or_filled() -> None:
    elevation = plane(50, 60, (10, 10), 0.5, 0.25)
    holed = elevation.copy()
    holed[20:30, 25:45] = np.nan
    with pytest.raises(AssetError, match=r"elevation.*200 holes.*row 20, column 25"):
        checked(Terrain(holed, (10.0, 10.0)))
    filled = checked(Terrain(holed, (10.0, 10.0)), holes="fill")
    # A plane is harmonic, so the membrane is the plane; 0.05 m of 112 m across the hole is left unsolved.
    np.testing.assert_allclose(filled.elevation, elevation, atol=0.05)
    assert np.array_equal(filled.elevation[~np.isnan(holed)], elevation[~np.isnan(holed)])
    assert "200 holes" in filled.notes[0]
    with pytest.raises(AssetError, match="no value at any node"):
        fill_holes(np.zeros((4, 4), dtype=np.float32), np.ones((4, 4), dtype=bool))


def test_a_filled_hole_stays_within_its_rim() -> None:
    """The maximum principle of harmonic functions, on rough ground and a hole that touches the edge."""
    rng = np.random.Generator(np.random.PCG64(8))
    elevation = rng.uniform(200, 300, (33, 47)).astype(np.float32)
    missing = np.zeros(elevation.shape, dtype=bool)
    missing[5:20, :30] = True
    filled = fill_holes(np.where(missing, 1e6, elevation).astype(np.float32), missing)
    assert 200 <= filled[missing].min() <= filled[missing].max() <= 300


@pytest.mark.parametrize(
    ("elevation", "cell", "field"),
    [
        (np.zeros((1, 1)), (1.0, 1.0), "elevation"),
        (np.zeros((1, 500)), (1.0, 1.0), "elevation"),
        (np.zeros((3, 3, 3)), (1.0, 1.0), "elevation"),
        (np.full((3, 3), np.inf), (1.0, 1.0), "elevation"),
        (np.full((3, 3), 1e30), (1.0, 1.0), "elevation"),
        (np.zeros((3, 3)), (0.0, 1.0), "cell_size"),
        (np.zeros((3, 3)), (1.0, -1.0), "cell_size"),
        (np.zeros((3, 3)), (1.0, math.nan), "cell_size"),
    ],
)
def test_no_terrain_is_refused_by_its_field(elevation: np.ndarray, cell: tuple[float, float], field: str) -> None:
    with pytest.raises(AssetError) as refusal:
        checked(Terrain(elevation.astype(np.float32), cell))
    assert refusal.value.field == field


def test_too_many_nodes_are_refused_before_they_are_touched() -> None:
    vast = np.broadcast_to(np.float32(0), (100_000, 100_000))
    with pytest.raises(LimitError, match=r"elevation.*100,000 x 100,000.*at most 1,000"):
        checked(Terrain(vast, (1.0, 1.0)), Limits(cells=1000))


def test_metres_of_a_degree() -> None:
    """Published: 111,319 m of longitude at the equator, 110,574 and 111,694 m of latitude at equator and pole."""
    assert metres_per_degree(0) == pytest.approx((111_319.491, 110_574.276), abs=0.01)
    assert metres_per_degree(89.99999)[1] == pytest.approx(111_693.98, abs=0.01)
    assert metres_per_degree(60)[0] == pytest.approx(55_800, abs=1)


def test_places_of_the_projections_known_here() -> None:
    """UTM of the CN Tower (a textbook example, metres); Web Mercator of 45 degrees; unknown systems have no place."""
    tower = place(Crs(32617, False), 630_084, 4_833_438)
    assert tower == pytest.approx((43 + 38 / 60 + 33.24 / 3600, -(79 + 23 / 60 + 13.7 / 3600)), abs=2e-5)
    south = place(Crs(32717, False), 630_084, 10_000_000 - 4_833_438)
    assert south == pytest.approx((-tower[0], tower[1]), abs=1e-9)
    assert place(Crs(3857, False), 0, 6_378_137 * math.asinh(1)) == pytest.approx((45, 0))
    assert place(Crs(2154, False), 700_000, 6_600_000) is None


def test_utm_northing_is_the_meridian_arc() -> None:
    """On the central meridian the northing is 0.9996 times the arc from the equator, by the trapezium rule."""
    phi = np.linspace(0, 52, 20_001)
    metres = np.array([metres_per_degree(float(p))[1] for p in phi])
    arc = float(np.sum((metres[1:] + metres[:-1]) / 2 * np.diff(phi)))
    latitude, longitude = place(Crs(25832, False), 500_000, 0.9996 * arc)
    assert latitude == pytest.approx(52, abs=1e-8)  # 1e-8 degree is 1 mm
    assert longitude == pytest.approx(9, abs=1e-12)
