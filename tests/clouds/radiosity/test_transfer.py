"""Transfer matrices: shares of light, over level ground in closed form, over relief by rays."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.clouds.radiosity import relief
from renderer.clouds.radiosity.bases import GRID, HALF, haar_basis, object_basis, solid_angle_basis
from renderer.clouds.radiosity.form_factors import rectangle
from renderer.clouds.radiosity.relief import NOTHING, Hits, cast, cell_areas, nodes_of, surface
from renderer.clouds.radiosity.transfer import Detail, Transfer, flat_transfer, relief_transfer
from renderer.core.errors import Cancelled, InputError

OBJECT = object_basis(64)
CORNERS = np.hypot(*np.meshgrid(*[np.linspace(-HALF, HALF, GRID + 1)] * 2))
CONE = 0.6 * np.maximum(0, 1 - CORNERS / 4)


@pytest.fixture(scope="module")
def cone() -> Hits:
    return cast(CONE, 128)


@pytest.fixture(scope="module")
def level() -> Hits:
    return cast(0 * CONE, 64)


@pytest.mark.parametrize("basis", [OBJECT, solid_angle_basis(64), object_basis(15)], ids=["object", "rings", "15"])
def test_rows_sum_to_what_the_square_shows(basis: object) -> None:
    found = flat_transfer(basis, basis)  # type: ignore[arg-type]
    assert found.flat
    for matrix in (found.from_cloud, found.from_ground):
        assert matrix.min() >= 0
        assert 0.2 < matrix.sum(axis=1).min() < matrix.sum(axis=1).max() < 1
    middle = found.from_cloud.sum(axis=1)[basis.labels[GRID // 2, GRID // 2]]  # type: ignore[attr-defined]
    if basis is not OBJECT:
        return
    assert middle == pytest.approx(float(rectangle((-18, 14), (-18, 14))), rel=2e-3)


def test_level_ground_has_one_set_for_both_ways() -> None:
    found = flat_transfer(OBJECT, OBJECT)
    np.testing.assert_allclose(found.from_cloud, found.from_cloud.T, atol=1e-7)
    np.testing.assert_allclose(found.from_cloud, found.from_ground, atol=1e-7)


def test_light_is_reciprocal_between_parts_of_other_size() -> None:
    rings = solid_angle_basis(64)
    found = flat_transfer(OBJECT, rings)
    np.testing.assert_allclose(
        found.from_cloud * OBJECT.sizes[:, None], (found.from_ground * rings.sizes[:, None]).T, atol=1e-4
    )


def test_wavelets_hold_the_blocks_matrix() -> None:
    """All wavelets down to the blocks' size: the same operator in other coordinates."""
    wavelets, blocks = haar_basis(np.arange(64)), flat_transfer(OBJECT, OBJECT)
    found = flat_transfer(wavelets, wavelets)
    field = np.random.default_rng(4).random((GRID, GRID))
    np.testing.assert_allclose(
        wavelets.synthesise(found.from_cloud @ wavelets.analyse(field)),
        OBJECT.synthesise(blocks.from_cloud @ OBJECT.analyse(field)),
        atol=1e-5,
    )


def test_rays_over_level_ground_give_the_closed_form(level: Hits) -> None:
    exact, found = flat_transfer(OBJECT, OBJECT), relief_transfer(level, OBJECT, OBJECT)
    one_ray = 1 / (64 * 64)  # of a block's: those few that rounding puts across a cell's edge
    for ours, theirs in ((found.from_cloud, exact.from_cloud), (found.from_ground, exact.from_ground)):
        assert np.abs(ours - theirs).max() <= 1.5 * one_ray
        assert np.mean(np.abs(ours - theirs) > 1e-6) < 0.03
    assert not found.on_ground.any()


def test_the_rays_alone_are_near_the_closed_form(level: Hits) -> None:
    """Without the level part that cancels: what they meet is what the kernel says."""
    blind = Hits(level.ground, level.cloud, np.full_like(level.ground, NOTHING), level.level_cloud, level.area * 1.001)
    exact, found = flat_transfer(OBJECT, OBJECT), relief_transfer(blind, OBJECT, OBJECT)
    assert np.abs(found.from_cloud - exact.from_cloud).max() < 0.01
    assert np.abs(found.from_cloud.sum(1) - exact.from_cloud.sum(1)).max() < 0.01


def test_rows_over_relief_are_shares(cone: Hits) -> None:
    for basis in (OBJECT, object_basis(256), solid_angle_basis(64)):
        found = relief_transfer(cone, basis, basis)
        assert (found.from_cloud.sum(1) + found.on_ground.sum(1)).max() <= 1 + 1e-6
        assert found.from_ground.sum(1).max() <= 1 + 1e-6
        assert found.on_ground.min() >= 0
        assert found.from_cloud.min() > -0.01


def test_slopes_see_the_ground_around(cone: Hits) -> None:
    """A slope of 0.15: (1 - cos) / 2 of its hemisphere, as flat ground all round would fill."""
    found = relief_transfer(cone, OBJECT, OBJECT)
    on_cone = OBJECT.labels[GRID // 2 + 2, GRID // 2 + 2]
    share = found.on_ground.sum(axis=1)
    assert share[on_cone] == pytest.approx((1 - np.cos(np.arctan(0.15))) / 2, rel=0.25)
    assert share[0] < 1e-3


def test_light_over_relief_is_reciprocal(cone: Hits) -> None:
    found = relief_transfer(cone, OBJECT, OBJECT)
    area = np.bincount(OBJECT.labels.ravel(), cone.area)
    there, back = found.from_cloud * area[:, None], (found.from_ground * area.min()).T
    np.testing.assert_allclose(there.sum(1), back.sum(1), rtol=0.02)


def test_snow_within_a_part_answers_for_it() -> None:
    """A part half black, half white: its light is that of its white half."""
    white = np.zeros((GRID, GRID))
    white[:, 4::8] = white[:, 5::8] = white[:, 6::8] = white[:, 7::8] = 1.0
    found = flat_transfer(OBJECT, OBJECT, Detail(albedo=white))
    lit = np.zeros(64)
    lit[0] = 0.5  # the mean: 1 on the white half
    exact = flat_transfer(object_basis(256), object_basis(256)).from_ground
    ours = (found.from_ground @ lit)[1]
    fine = object_basis(256)
    half = np.zeros(256)
    half[np.unique(fine.labels[:8, 4:8])] = 1.0
    assert ours == pytest.approx((exact @ half)[np.unique(fine.labels[:8, 8:16])].mean(), rel=1e-3)
    plain = flat_transfer(OBJECT, OBJECT)
    assert (plain.from_ground @ lit)[1] < 0.95 * ours


def test_the_surface_is_its_triangles() -> None:
    x, y = np.random.default_rng(6).uniform(-HALF, HALF, (2, 500))
    z, gx, gy = surface(CONE, x, y)
    step = 1e-6
    np.testing.assert_allclose((surface(CONE, x + step, y)[0] - z) / step, gx, atol=1e-3)
    np.testing.assert_allclose((surface(CONE, x, y + step)[0] - z) / step, gy, atol=1e-3)
    assert cell_areas(0 * CONE) == pytest.approx(0.25)
    slope = np.linspace(0, 0.9, GRID + 1)[None, :] * np.ones((GRID + 1, 1))
    assert cell_areas(slope) == pytest.approx(0.25 * np.sqrt(1 + (0.9 / 32) ** 2))


def test_corners_are_the_mean_of_the_cells_around() -> None:
    cells = np.arange(9.0).reshape(3, 3)
    assert nodes_of(cells).shape == (4, 4)
    assert nodes_of(cells)[1, 1] == pytest.approx(2)
    assert nodes_of(cells)[0, 0] == 0


def test_ground_in_the_cloud_is_refused_and_work_can_stop(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match="elevation"):
        cast(CONE + 0.5, 64)

    def stop(share: float, words: str) -> None:
        raise Cancelled("enough")

    with pytest.raises(Cancelled):
        cast(CONE, 64, stop)
    assert relief.RAYS == 2048


def test_arrays_go_to_the_cache_and_back() -> None:
    found = flat_transfer(OBJECT, OBJECT)
    again = Transfer.of(found.arrays())
    assert (again.from_cloud == found.from_cloud).all()
    assert again.from_cloud.dtype == np.float32
