"""The exact horizon: closed forms, dense sampling, and values computed elsewhere with other code."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from renderer.core.errors import InputError
from renderer.reference.horizon import horizon
from renderer.world.terrain import default_terrain

# (row, col), azimuth clockwise from north in degrees, horizon in rad, distance in m.
# From ../shared/reference/e_dem_horizons.npz, whose azimuths run counter-clockwise from east; recipe in its README.
PUBLISHED = [
    ((163, 109), 90.0, 0.048052634595077685, 4678.761030547344),
    ((163, 109), 337.5, 0.008096034120765469, 6519.6090197611875),
    ((163, 109), 225.0, 0.15176012510792788, 589.0389213371047),
    ((335, 350), 90.0, 0.05380842114370863, 0.0),
    ((335, 350), 337.5, 0.014915147816758264, 25276.022661227988),
    ((335, 350), 112.5, 0.027142842433076374, 484.29933898084386),
    ((281, 276), 90.0, -0.020687328825818953, 9134.72391678291),
    ((281, 276), 337.5, 0.2550509569096216, 200.60335445419037),
    ((281, 276), 112.5, -0.02720679979492725, 9443.837110126455),
]
SHARED = Path(__file__).parents[3] / "shared" / "reference" / "e_dem_horizons.npz"


def look(
    elevation: np.ndarray, point: tuple[float, float], azimuth: float, cell: tuple[float, float] = (1.0, 1.0)
) -> tuple[float, float]:
    angle, distance = horizon(elevation, cell, np.array([point], float), np.radians([azimuth]))
    return float(angle[0, 0]), float(distance[0, 0])


def test_values_published_elsewhere() -> None:
    terrain = default_terrain()
    for point, azimuth, angle, distance in PUBLISHED:
        found = look(terrain.elevation, point, azimuth, terrain.cell_size)
        # the published cell sizes carry 9 digits
        assert found[0] == pytest.approx(angle, abs=1e-8)
        assert found[1] == pytest.approx(distance, abs=1e-3)


@pytest.mark.skipif(not SHARED.is_file(), reason="no shared set beside this checkout; its copy above always runs")
def test_whole_published_set() -> None:
    data = np.load(SHARED)
    terrain = default_terrain()
    azimuths = np.radians((90.0 - data["azimuth_deg"]) % 360.0)
    angle, distance = horizon(terrain.elevation, (float(data["dx_m"]), float(data["dy_m"])), data["row_col"], azimuths)
    assert np.abs(angle - data["horizon_rad"]).max() < 1e-12
    differs = np.abs(distance - data["distance_m"]) > 1e-3
    # integer heights tie exactly along diagonals and grid lines, where rounding chose a farther place in that set
    assert differs.sum() <= 2
    assert (distance[differs] < data["distance_m"][differs]).all()


def test_counter_clockwise_azimuths_are_rejected() -> None:
    terrain = default_terrain()
    point, azimuth, angle, _ = PUBLISHED[1]
    assert abs(look(terrain.elevation, point, 90.0 - azimuth, terrain.cell_size)[0] - angle) > 1e-3


def test_wall_at_a_known_distance_in_each_quarter() -> None:
    grid = np.zeros((21, 21))
    grid[:, 15] = 3.0
    # the wall's crest is the line of nodes 5 columns east: 5 * 2 m away
    assert look(grid, (10, 10), 90, (2.0, 3.0)) == pytest.approx((np.arctan(3 / 10), 10.0))
    assert look(grid, (10, 10), 270, (2.0, 3.0)) == (0.0, 0.0)
    grid = np.zeros((21, 21))
    grid[4, :] = 3.0
    assert look(grid, (10, 10), 0, (2.0, 3.0)) == pytest.approx((np.arctan(3 / 18), 18.0))
    assert look(grid, (10, 10), 180, (2.0, 3.0)) == (0.0, 0.0)


def test_stationary_point_inside_a_saddle_cell() -> None:
    # on the diagonal of a cell with corner heights 0, 1, 1, 0 the surface is 2u(1-u): steepest seen at u -> 0
    grid = np.array([[0.0, 1.0], [1.0, 0.0]])
    angle, distance = look(grid, (0, 0), 135)
    assert angle == pytest.approx(np.arctan(2 / np.sqrt(2)))
    assert distance == 0
    # behind a flat cell the same hump is seen from outside: maximum of 2u(1-u)/((1+u) sqrt 2) at u = sqrt 2 - 1
    grid = np.zeros((3, 3))
    grid[1, 2] = grid[2, 1] = 1.0
    u = np.sqrt(2) - 1
    angle, distance = look(grid, (0.0, 0.0), 135)
    assert np.tan(angle) == pytest.approx(2 * u * (1 - u) / ((1 + u) * np.sqrt(2)))
    assert distance == pytest.approx((1 + u) * np.sqrt(2))


def test_falling_ground_is_not_clamped() -> None:
    rows = np.arange(9, dtype=float)
    grid = np.repeat(-0.5 * rows[:, None], 9, axis=1)
    assert look(grid, (2, 4), 180) == pytest.approx((np.arctan(-0.5), 0.0))
    assert look(grid, (2, 4), 0) == pytest.approx((np.arctan(0.5), 0.0))


def test_nothing_beyond_the_edge() -> None:
    assert look(np.ones((4, 4)), (0, 2), 0) == (-np.pi / 2, 0.0)
    assert look(np.ones((4, 4)), (0, 2), 180) == (0.0, 0.0)


def test_dense_sampling_never_exceeds_it_and_comes_close() -> None:
    rng = np.random.default_rng(5)
    grid = rng.random((17, 23)).cumsum(0)
    cell = (1.5, 0.7)
    for point, azimuth in [((8.0, 11.0), 33.0), ((3.25, 17.75), 200.0), ((12.0, 4.5), 301.0)]:
        angle, _ = look(grid, point, azimuth, cell)
        s = np.linspace(1e-6, 40, 400_000)
        row, col = (
            point[0] - s * np.cos(np.radians(azimuth)) / cell[1],
            point[1] + s * np.sin(np.radians(azimuth)) / cell[0],
        )
        inside = (row >= 0) & (row <= 16) & (col >= 0) & (col <= 22)
        s, row, col = s[inside], row[inside], col[inside]
        i, j = np.minimum(row.astype(int), 15), np.minimum(col.astype(int), 21)
        v, u = row - i, col - j
        height = (grid[i, j] * (1 - u) + grid[i, j + 1] * u) * (1 - v) + (
            grid[i + 1, j] * (1 - u) + grid[i + 1, j + 1] * u
        ) * v
        sampled = np.arctan(((height - height[0]) / s)[1:].max())
        assert sampled - 1e-4 < angle, "the first sample stands a micrometre away, on a slope below 30"
        assert angle - sampled < 2e-3


def test_raising_the_ground_never_lowers_a_horizon() -> None:
    rng = np.random.default_rng(6)
    grid = rng.random((12, 12))
    points, azimuths = np.array([[5.0, 5.0]]), np.radians(np.arange(0, 360, 7.0))
    before, _ = horizon(grid, (1, 1), points, azimuths)
    grid[1, 9] += 2.0
    after, _ = horizon(grid, (1, 1), points, azimuths)
    assert (after >= before).all()
    assert (after > before).any()


@pytest.mark.parametrize(
    ("grid", "point", "field"),
    [
        (np.zeros((1, 5)), (0, 0), "elevation"),
        (np.full((3, 3), np.nan), (1, 1), "elevation"),
        (np.zeros((3, 3)), (1, 3), "points"),
        (np.zeros((3, 3)), (np.nan, 0), "points"),
    ],
)
def test_bad_input_names_its_field(grid: np.ndarray, point: tuple[float, float], field: str) -> None:
    with pytest.raises(InputError) as failure:
        look(grid, point, 0)
    assert failure.value.field == field


def test_a_cell_of_no_size_is_refused() -> None:
    with pytest.raises(InputError, match="cell_size"):
        look(np.zeros((3, 3)), (1, 1), 0, (0.0, 1.0))
