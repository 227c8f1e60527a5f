"""Bounces by matrices: fixed, direct and by GMRES; one square and many."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.clouds.radiosity.bases import GRID, Basis, haar_basis, object_basis
from renderer.clouds.radiosity.flat import bounce
from renderer.clouds.radiosity.kernel import flat_exchange
from renderer.clouds.radiosity.numbers import truncation
from renderer.clouds.radiosity.solve import Answers, Squares, by_bounces, by_gmres, direct
from renderer.clouds.radiosity.transfer import Transfer, flat_transfer

OBJECT = object_basis(64)
FLAT = flat_transfer(OBJECT, OBJECT)
CHANCE = np.random.default_rng(9)
ALBEDO, REFLECTANCE, SUN = CHANCE.uniform(0.1, 0.9, (3, GRID, GRID))


def answers(basis: Basis = OBJECT) -> Answers:
    return Answers.of(basis, basis, ALBEDO, REFLECTANCE)


def first(basis: Basis = OBJECT) -> tuple[np.ndarray, np.ndarray]:
    return basis.analyse(ALBEDO * SUN).astype(np.float32), np.zeros(basis.n, np.float32)


def test_three_ways_to_one_solution() -> None:
    exact = direct(FLAT, answers(), *first())
    for found in (by_bounces(FLAT, answers(), *first(), 80), by_gmres(FLAT, answers(), *first())):
        for ours, theirs in zip(found, exact, strict=True):
            np.testing.assert_allclose(ours, theirs, rtol=1e-4, atol=1e-6)


def test_few_bounces_leave_their_share_out_and_the_tail_brings_it_back() -> None:
    """Endless uniform planes, as one function that sees itself alone."""
    one = Transfer(np.ones((1, 1), np.float32), np.ones((1, 1), np.float32), np.zeros((1, 1), np.float32))
    bright = Answers(np.full((1, 1), 0.8, np.float32), np.full((1, 1), 0.9, np.float32))
    lit = np.array([0.8], np.float32), np.array([0.0], np.float32)
    exact = direct(one, bright, *lit)[0][0]
    assert exact == pytest.approx(0.8 * 0.9 / (1 - 0.72), rel=1e-5)
    short = by_bounces(one, bright, *lit, 8)[0][0]
    assert 1 - short / exact == pytest.approx(truncation(0.72, 3), rel=1e-3)
    assert by_bounces(one, bright, *lit, 8, tail=True)[0][0] == pytest.approx(exact, rel=1e-4)


def test_bounces_are_those_of_the_fine_kernel() -> None:
    """Smooth light: blocks of 4H give what cells of half a height do."""
    smooth = 0.5 + 0.3 * np.sin(np.linspace(0, 3, GRID))[:, None] * np.ones(GRID)
    fine = bounce(
        flat_exchange(GRID, 0.5), smooth[None], 0 * smooth[None], 0.4 + 0 * smooth[None], 0.8 + 0 * smooth[None], 60
    )
    basis = object_basis(256)
    matrices = flat_transfer(basis, basis)
    flat = Answers.of(basis, basis, 0.4 + 0 * smooth, 0.8 + 0 * smooth)
    found = direct(matrices, flat, basis.analyse(smooth).astype(np.float32), np.zeros(256, np.float32))
    inner = np.unique(basis.labels[16:48, 16:48])
    for ours, theirs in zip(found, fine, strict=True):
        np.testing.assert_allclose(ours[inner], basis.means(theirs[0])[inner], rtol=5e-3)


def test_holes_in_the_cloud_are_left_out() -> None:
    holes = REFLECTANCE * (np.arange(GRID) < 32)
    given = Answers.of(OBJECT, OBJECT, ALBEDO, holes)
    found = direct(FLAT, given, *first())
    again = by_bounces(FLAT, given, *first(), 80)
    np.testing.assert_allclose(found[0], again[0], rtol=1e-4)
    np.testing.assert_allclose(found[1], again[1], rtol=1e-4)


def test_wavelets_solve_as_blocks_do() -> None:
    wavelets = haar_basis(np.arange(64))
    matrices = flat_transfer(wavelets, wavelets)
    blocks = direct(FLAT, answers(), *first())
    # Blocks' albedo, for wavelets to multiply the same.
    given = Answers.of(wavelets, wavelets, *(OBJECT.synthesise(OBJECT.means(f)) for f in (ALBEDO, REFLECTANCE)))
    lit = wavelets.analyse(ALBEDO * SUN).astype(np.float32), np.zeros(64, np.float32)
    for ours, theirs in zip(direct(matrices, given, *lit), blocks, strict=True):
        np.testing.assert_allclose(wavelets.synthesise(ours), OBJECT.synthesise(theirs), atol=1e-4)


def many(squares: int) -> tuple[Squares, np.ndarray, np.ndarray, np.ndarray]:
    albedo, shine = CHANCE.uniform(0.1, 0.9, (2, squares, 3, 64)).astype(np.float32)
    lit = albedo * CHANCE.random((squares, 3, 64), np.float32)
    return Squares([FLAT] * squares, albedo, shine), albedo, shine, lit


def test_many_squares_are_many_solutions() -> None:
    solver, albedo, shine, lit = many(3)
    cloud = shine * 0.1
    found = solver.solve(lit, cloud)
    for k in range(3):
        for band in range(3):
            given = Answers(np.diag(albedo[k, band]), np.diag(shine[k, band]))
            exact = direct(FLAT, given, lit[k, band], cloud[k, band])
            np.testing.assert_allclose(found[0][k, band], exact[0], rtol=1e-4)
            np.testing.assert_allclose(found[1][k, band], exact[1], rtol=1e-4)
