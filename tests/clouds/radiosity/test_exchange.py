"""Half-bounces on a grid: the exact kernel by FFT, three levels beside it, and bounces summed."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.clouds.radiosity.flat import bounce, half_bounces_for
from renderer.clouds.radiosity.form_factors import level_weights, rectangle
from renderer.clouds.radiosity.kernel import FlatExchange
from renderer.clouds.radiosity.levels import ThreeLevelExchange

READINGS = ("texels", "taps", "discs")


def block(n: int, low: int, high: int) -> np.ndarray:
    field = np.zeros((n, n))
    field[low:high, low:high] = 1
    return field


def test_a_square_of_light_falls_as_its_form_factor() -> None:
    found = FlatExchange(32, 0.5, 1.0, points=True)(block(32, 12, 20))
    middles = (np.arange(32) + 0.5 - 16) * 0.5
    x, y = middles[None, :], middles[:, None]
    np.testing.assert_allclose(found, rectangle((-2 - x, 2 - x), (-2 - y, 2 - y)), atol=1e-12)


def test_means_over_cells_are_reciprocal_and_lose_what_leaves() -> None:
    exchange = FlatExchange(16, 0.5, 1.0)
    one, other = np.random.default_rng(1).random((2, 16, 16))
    assert np.sum(exchange(one) * other) == pytest.approx(np.sum(exchange(other) * one))
    assert exchange(np.ones((16, 16))).max() < 1
    assert exchange(one.astype(np.float32)).dtype == np.float32
    np.testing.assert_allclose(exchange(one.astype(np.float32)), exchange(one), atol=1e-6)


def test_a_plane_that_goes_on_stays_uniform() -> None:
    for exchange in (FlatExchange(16, 0.5, 1.0), *(ThreeLevelExchange(16, 0.5, 1.0, r) for r in READINGS)):
        np.testing.assert_allclose(exchange.spread(np.full((3, 16, 16), 2.5)), 2.5, rtol=1e-6)


def test_levels_by_hand() -> None:
    """A lit block of 8H around the middle: texels see it whole or not at all, discs as far as it fills them."""
    lit = block(64, 16, 32)  # one texel of the coarsest level
    texels = ThreeLevelExchange(64, 0.5, 1.0, "texels")(lit)
    assert texels[20, 20] == pytest.approx(1)
    assert texels[20, 33] == 0, "beyond the texel's edge all is dark"
    taps = ThreeLevelExchange(64, 0.5, 1.0, "taps")(lit)
    # Half a cell inside the edge: so much of each level's tap is lit, the coarsest's along the rows too.
    shares = 0.75, 0.625, (1 - 7.5 / 16) * (1 - 0.5 / 16)
    assert taps[23, 31] == pytest.approx(level_weights("taps") @ shares, rel=1e-6)
    discs = ThreeLevelExchange(64, 0.5, 1.0, "discs")(block(64, 27, 36))
    assert discs[31, 31] == pytest.approx(level_weights("discs") @ (1, 1, 4.5**2 / (64 * np.pi)), rel=1e-2)


def test_levels_want_texels_that_fit() -> None:
    with pytest.raises(ValueError, match="cut"):
        ThreeLevelExchange(60, 0.5, 1.0, "taps")
    with pytest.raises(ValueError, match="cut"):
        ThreeLevelExchange(64, 0.3, 1.0, "texels")


@pytest.mark.parametrize("reading", READINGS)
def test_cells_wider_than_a_level_hold_it_whole(reading: str) -> None:
    """Seen from far a cell is 2H wide: the means over H and 2H are its own."""
    lit = np.random.default_rng(8).random((64, 64))
    means = ThreeLevelExchange(64, 2.0, 1.0, reading).means(lit)  # type: ignore[arg-type]
    np.testing.assert_allclose(means[0], lit, atol=1e-6)
    assert np.abs(means[2] - lit).mean() > 0.1


def cone_of_error(reading: str) -> float:
    lit = np.random.default_rng(3).random((64, 64)).cumsum(0).cumsum(1) % 300 / 300
    exact = FlatExchange(64, 0.5, 1.0).spread(lit)
    found = ThreeLevelExchange(64, 0.5, 1.0, reading).spread(lit)  # type: ignore[arg-type]
    return float(np.sqrt(np.mean((found - exact)[16:48, 16:48] ** 2)) / exact.mean())


def test_smooth_footprints_are_nearer_the_kernel_than_texels() -> None:
    assert max(cone_of_error("taps"), cone_of_error("discs")) < 0.06 < 0.1 < cone_of_error("texels")


def uniform(product: tuple[float, float], half_bounces: int, tail: bool) -> float:
    """Ground irradiance added between endless planes, the ground lit with 1."""
    ground, cloud = product
    ones = np.ones((1, 16, 16))
    exchange = FlatExchange(16, 0.5, 1.0).spread
    return float(bounce(exchange, ground * ones, 0 * ones, ground * ones, cloud * ones, half_bounces, tail)[0].mean())


def test_uniform_planes_sum_to_the_closed_form() -> None:
    for ground, cloud in ((0.3, 0.9), (0.8, 0.9), (0.95, 0.95)):
        product = ground * cloud
        exact = product / (1 - product)
        assert uniform((ground, cloud), 4, True) == pytest.approx(exact, rel=1e-6), "the tail is the geometric series"
        for bounces in (2, 4):
            left = exact - uniform((ground, cloud), 2 * bounces, False)
            assert left == pytest.approx(product ** (bounces + 1) / (1 - product), rel=1e-6)


def test_a_path_counts_once() -> None:
    """Both sides from the other's last term: feeding the sum back would count paths again."""
    found = uniform((0.3, 0.9), 40, False)
    assert found == pytest.approx(0.27 / 0.73, rel=1e-6)


def test_the_bounces_wanted_follow_the_albedo() -> None:
    assert half_bounces_for(np.array([0.3]), np.array([0.9]), 1e-3) == 12
    assert half_bounces_for(np.array([0.0]), np.array([0.9]), 1e-3) == 2
    assert half_bounces_for(np.array([1.0]), np.array([1.0]), 1e-3) == 400
