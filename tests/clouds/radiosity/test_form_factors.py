"""Form factors in closed form against quadrature, and the three readings of the levels."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.clouds.radiosity.form_factors import (
    cells,
    disc,
    footprints,
    level_weights,
    nested_weights,
    rectangle,
    square,
)

NODES, WEIGHTS = np.polynomial.legendre.leggauss(60)


def by_quadrature(x: tuple[float, float], y: tuple[float, float], height: float) -> float:
    px = (x[0] + x[1]) / 2 + NODES * (x[1] - x[0]) / 2
    py = (y[0] + y[1]) / 2 + NODES * (y[1] - y[0]) / 2
    kernel = height**2 / (np.pi * (height**2 + px[:, None] ** 2 + py[None, :] ** 2) ** 2)
    return float(WEIGHTS @ kernel @ WEIGHTS * (x[1] - x[0]) * (y[1] - y[0]) / 4)


@pytest.mark.parametrize(
    ("x", "y", "height"),
    [
        ((-1, 1), (-2, 3), 1.0),
        ((0.5, 2), (1, 1.5), 1.0),
        ((-3, -1), (2, 4), 2.5),
        ((100, 300), (-50, 50), 250.0),
    ],
)
def test_a_rectangle_is_its_integral(x: tuple[float, float], y: tuple[float, float], height: float) -> None:
    assert float(rectangle(x, y, height)) == pytest.approx(by_quadrature(x, y, height), rel=1e-9)


def test_discs_and_squares_reach_the_hemisphere() -> None:
    assert 1 - float(disc(8.0)) == pytest.approx(1 / 65, rel=1e-12)
    assert float(disc(2500.0, 2500.0)) == pytest.approx(0.5)
    assert float(square(1e6)) == pytest.approx(1, abs=1e-9)
    assert float(disc(3.0)) < float(square(6.0)) < float(disc(3.0 * np.sqrt(2)))


def test_the_mean_over_a_cell_is_its_integral() -> None:
    """Four nested quadratures, for cells opposite, aside and far."""
    found = cells(6, 2.0)
    nodes, weights = np.polynomial.legendre.leggauss(24)
    share = np.outer(weights, weights)
    for row, column in ((0, 0), (1, 0), (2, 3), (6, 6)):
        dx = (nodes[:, None] - nodes + 2 * column) ** 2
        dy = (nodes[:, None] - nodes + 2 * row) ** 2
        kernel = 1 / (np.pi * (1 + dy[:, :, None, None] + dx) ** 2)
        mean = np.einsum("ab,cd,abcd", share, share, kernel) / 4
        assert found[6 + row, 6 + column] == pytest.approx(mean, rel=1e-6)


def test_cells_of_every_size_lose_only_what_lies_beyond() -> None:
    for cell in (0.25, 1.0, 4.0):
        reach = round(64 / cell)
        assert float(cells(reach, cell).sum()) == pytest.approx(float(square((2 * reach + 1) * cell)), abs=1e-3)
    np.testing.assert_allclose(cells(3, 500.0, 1000.0), cells(3, 0.5), rtol=1e-12)


@pytest.mark.parametrize(
    ("reading", "factors", "weights"),
    [
        ("texels", (0.239, 0.554, 0.951), (0.1346, 0.3931, 0.4238)),
        ("taps", (0.554, 0.831, 0.987), (0.4618, 0.3588, 0.1668)),
        ("discs", (0.5, 0.8, 0.985), (0.4, 0.388, 0.197)),
    ],
)
def test_the_three_readings_are_those_of_formulas_a7(reading: str, factors: tuple, weights: tuple) -> None:
    np.testing.assert_allclose(footprints(reading)[1], factors, atol=6e-4)  # type: ignore[arg-type]
    np.testing.assert_allclose(level_weights(reading, spread_loss=False), weights, atol=6e-4)  # type: ignore[arg-type]
    assert level_weights(reading).sum() == pytest.approx(1)  # type: ignore[arg-type]


def test_weights_give_each_ring_its_own_share() -> None:
    """Light of the outer ring alone: the means over the nested discs hold it diluted, the weights undo that."""
    areas, factors = footprints("discs")
    inner = np.array([0.0, 0.0, 1 - areas[1] / areas[2]])
    weights = nested_weights(areas, factors, spread_loss=False)
    assert weights @ inner == pytest.approx(factors[2] - factors[1])
    # The factors themselves, or their differences, as weights of the means would give other light.
    assert abs(factors @ inner - (factors[2] - factors[1])) > 0.5
    assert abs(np.diff(factors, prepend=0) @ inner - (factors[2] - factors[1])) > 0.01
