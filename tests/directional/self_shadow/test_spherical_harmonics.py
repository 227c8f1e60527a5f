"""Spherical harmonics: their own functions come back, errors fall with the order, and the same in GLSL."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.directional.codes.code import SIZES, cells_of, decode
from renderer.directional.codes.spherical_harmonics import SphericalHarmonics as Code
from renderer.directional.codes.spherical_harmonics import basis
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


def test_even_skies_and_bounds_come_back() -> None:
    """All lit and all dark are functions of order 0; the bounds of a coefficient are met by masks."""
    code = Code(LAYOUT)
    even = np.stack([np.ones(129, bool), np.zeros(129, bool)])
    np.testing.assert_allclose(decode(code, code.encode(even)), even, atol=0.05)
    words = code.encode(code._fit > 0)
    assert (words[0, 0] & 255) == 255


@pytest.mark.parametrize("size", SIZES)
def test_glsl_reads_as_numpy(see: Callable, size: int) -> None:
    code, given = Code(LAYOUT, size), towards(300)
    words = code.encode(caps(LAYOUT, 300))
    seen = see(SphericalHarmonics(size=size), LAYOUT, words, given, self_shadow_ranges=code.ranges)
    assert np.abs(seen - twin(code, words, given)).max() < 1e-3


def test_higher_orders_misjudge_less() -> None:
    found = [errors(Code(LAYOUT, size), caps(LAYOUT, 600)) for size in SIZES]
    assert found == sorted(found, reverse=True)
    rms, wrong = errors(Code(LAYOUT), dem_x4())
    assert rms < 0.27
    assert wrong < 0.06


def test_quantising_costs_little() -> None:
    code, masks = Code(LAYOUT), caps(LAYOUT, 300)
    exact = masks @ code._fit.T @ basis(LAYOUT.directions(), 2).T
    assert np.sqrt(((decode(code, code.encode(masks)) - exact) ** 2).mean()) < 0.02
    assert cells_of(LAYOUT).shape == (129, 2)


@pytest.mark.parametrize(
    ("right", "wrong"),
    [("3.0 * zz - 1.0, x * z", "3.0 * zz, x * z"), ("vec4(1.0, y, z, x)", "vec4(1.0, x, y, z)")],
)
def test_a_wrong_function_is_found(see: Callable, spoil: Callable, right: str, wrong: str) -> None:
    code, given = Code(LAYOUT), towards(300)
    words = code.encode(caps(LAYOUT, 300))
    with spoil(FILE, right, wrong):
        seen = see(SphericalHarmonics(), LAYOUT, words, given, self_shadow_ranges=code.ranges)
        assert np.abs(seen - twin(code, words, given)).max() > ARC
