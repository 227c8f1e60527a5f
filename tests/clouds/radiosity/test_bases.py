"""The three bases: how many functions, what they keep, and how products are taken."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.clouds.radiosity.bases import (
    CELL,
    GRID,
    HALF,
    Basis,
    haar_basis,
    haar_matrix,
    largest_wavelets,
    object_basis,
    solid_angle_basis,
    triple_products,
)

COUNTS = (15, 64, 256)
FIELD = np.random.default_rng(5).random((GRID, GRID))
COARSE = np.arange(256)


def every(count: int) -> list[Basis]:
    return [object_basis(count), solid_angle_basis(count), haar_basis(largest_wavelets(FIELD[None], count))]


@pytest.mark.parametrize("count", COUNTS)
def test_there_are_as_many_functions_as_asked_for(count: int) -> None:
    for basis in every(count):
        assert basis.n == count
        assert basis.sizes.min() >= 1
        assert basis.sizes.sum() == GRID * GRID


@pytest.mark.parametrize("count", COUNTS)
def test_what_is_in_the_basis_comes_back(count: int) -> None:
    for basis in every(count):
        field = basis.synthesise(np.random.default_rng(2).random((3, basis.n)))
        np.testing.assert_allclose(basis.synthesise(basis.analyse(field)), field, atol=1e-12)
        assert basis.synthesise(basis.analyse(FIELD)).mean() == pytest.approx(FIELD.mean())


def test_cells_of_constant_solid_angle_have_it() -> None:
    """Fine in the middle, coarse at the rim; the cells' solid angles from their point agree as the grid allows."""
    basis = solid_angle_basis(64, 8.0)
    places = (np.arange(GRID) + 0.5) * CELL - HALF
    far = np.hypot(places[:, None], places[None, :])
    angle = np.bincount(basis.labels.ravel(), ((8.0 / np.hypot(8.0, far)) ** 3 * CELL**2 / 64).ravel())
    within = np.unique(basis.labels[far < 11])
    assert angle[within].std() / angle[within].mean() < 0.15
    assert basis.sizes[basis.labels[GRID // 2, GRID // 2]] < 0.2 * basis.sizes[basis.labels[0, GRID // 2]]
    finer = solid_angle_basis(64, 4.0)
    assert finer.sizes[finer.labels[GRID // 2, GRID // 2]] < basis.sizes[basis.labels[GRID // 2, GRID // 2]]


def test_wavelets_are_orthonormal_and_the_coarse_ones_are_blocks() -> None:
    matrix = haar_matrix()
    np.testing.assert_allclose(matrix @ matrix.T, np.eye(1024), atol=1e-12)
    assert matrix[0] == pytest.approx(1 / 32)
    coarse = haar_basis(COARSE)
    np.testing.assert_allclose(
        coarse.synthesise(coarse.analyse(FIELD)),
        (blocks := object_basis(256)).synthesise(blocks.analyse(FIELD)),
        atol=1e-12,
    )


def test_the_largest_wavelets_beat_the_coarse_ones_at_an_edge() -> None:
    edge = (np.add.outer(np.arange(GRID), np.arange(GRID)) < 70).astype(float)
    kept = [haar_basis(rows) for rows in (largest_wavelets(edge[None], 64), np.arange(64))]
    errors = [float(np.mean((basis.synthesise(basis.analyse(edge)) - edge) ** 2)) for basis in kept]
    assert errors[0] < 0.5 * errors[1]


def test_importance_moves_wavelets_to_where_they_count() -> None:
    importance = np.full((GRID, GRID), 0.01)
    importance[:16, :16] = 1
    kept = haar_basis(largest_wavelets(FIELD[None], 64, importance))
    error = np.abs(kept.synthesise(kept.analyse(FIELD)) - FIELD)
    assert error[:16, :16].mean() < 0.85 * error[32:, 32:].mean()


def test_a_product_is_that_of_the_triple_products() -> None:
    """The matrix of a product with a field, entry by entry from the integrals of three wavelets."""
    found = triple_products(4)
    assert 0 < len(found) < 16**3 / 30, "most vanish"
    matrix, field = haar_matrix(4), np.random.default_rng(3).random(16)
    basis = Basis(np.arange(GRID * GRID).reshape(GRID, GRID) % 16, matrix)
    coefficients = matrix @ field
    by_integrals = np.zeros((16, 16))
    for rows, value in found.items():
        for i, j, k in {
            (rows[a], rows[b], rows[c])
            for a, b, c in ((0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0))
        }:
            by_integrals[i, j] += coefficients[k] * value
    np.testing.assert_allclose(by_integrals, basis.multiply(field), atol=1e-12)
    wrong = dict(list(found.items())[1:])
    assert len(wrong) == len(found) - 1
    assert np.abs(by_integrals - np.diag(np.diag(by_integrals))).max() > 0.1, "wavelets do not multiply one by one"


def test_indicator_functions_multiply_one_by_one() -> None:
    basis = object_basis(64)
    np.testing.assert_array_equal(basis.multiply(np.arange(64.0)), np.diag(np.arange(64.0)))
