"""Spherical harmonics: their own functions come back, errors fall with the order, and the same in GLSL."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.directional.codes.code import SIZES, decode
from renderer.directional.codes.spherical_harmonics import basis, fit, fitted
from renderer.directional.hemisphere import hemisphere_of
from renderer.directional.self_shadow.spherical_harmonics import SphericalHarmonics
from tests.directional.self_shadow.conftest import ARC, caps, dem_x4, errors, towards, twin

FILE = "directional/self_shadow/spherical_harmonics.glsl"
LAYOUT = hemisphere_of(129)


def test_functions_are_orthogonal_on_the_whole_sphere() -> None:
    given = towards(60_000, seed=8)
    functions = basis(given, 4)
    product = functions.T @ functions / len(given)
    scale = np.sqrt(np.diag(product))
    np.testing.assert_allclose(product / np.outer(scale, scale), np.eye(25), atol=0.03)


def test_even_skies_and_extremes_come_back() -> None:
    """All lit and all dark are functions of order 0; the greatest coefficients have the last code."""
    masks = np.concatenate([[np.ones(129, bool), np.zeros(129, bool)], caps(LAYOUT, 200)])
    code = fitted(LAYOUT, 9, masks)
    np.testing.assert_allclose(decode(code, code.encode(masks[:2])), masks[:2], atol=0.03)
    codes = code.encode(masks)[:, 0] & 255
    assert (codes.min(), codes.max()) == (0, 255)


@pytest.mark.parametrize("size", SIZES)
def test_glsl_reads_as_numpy(see: Callable, size: int) -> None:
    masks, given = caps(LAYOUT, 300), towards(300)
    code = fitted(LAYOUT, size, masks)
    words = code.encode(masks)
    seen = see(SphericalHarmonics(size=size), LAYOUT, words, given, self_shadow_ranges=code.ranges)
    assert np.abs(seen - twin(code, words, given)).max() < 1e-3


def test_higher_orders_misjudge_less() -> None:
    masks = caps(LAYOUT, 600)
    found = [errors(fitted(LAYOUT, size, masks), masks) for size in SIZES]
    assert found == sorted(found, reverse=True)
    rms, wrong = errors(fitted(LAYOUT, 9, dem_x4()), dem_x4())
    assert rms < 0.27
    assert wrong < 0.06


def test_quantising_costs_little() -> None:
    masks = caps(LAYOUT, 300)
    code = fitted(LAYOUT, 9, masks)
    exact = masks @ fit(LAYOUT, 2).T @ basis(LAYOUT.directions(), 2).T
    assert np.sqrt(((decode(code, code.encode(masks)) - exact) ** 2).mean()) < 0.02


@pytest.mark.parametrize(
    ("right", "wrong"),
    [("3.0 * zz - 1.0, x * z", "3.0 * zz, x * z"), ("vec4(1.0, y, z, x)", "vec4(1.0, x, y, z)")],
)
def test_a_wrong_function_is_found(see: Callable, spoil: Callable, right: str, wrong: str) -> None:
    masks, given = caps(LAYOUT, 300), towards(300)
    code = fitted(LAYOUT, 9, masks)
    words = code.encode(masks)
    with spoil(FILE, right, wrong):
        seen = see(SphericalHarmonics(), LAYOUT, words, given, self_shadow_ranges=code.ranges)
        assert np.abs(seen - twin(code, words, given)).max() > ARC
