"""A ring of horizons: exact for land, too dark under what hangs over a point, and the same in GLSL."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.directional.codes.code import get, judged
from renderer.directional.codes.horizon_ring import SECTORS
from renderer.directional.codes.horizon_ring import HorizonRing as Code
from renderer.directional.hemisphere import hemisphere_of
from renderer.directional.self_shadow.horizon_ring import HorizonRing
from tests.directional.self_shadow.conftest import ARC, caps, dem_x4, errors, horizons, towards, twin

FILE = "directional/shadow_ring.glsl"
LAYOUT = hemisphere_of(129)


def test_land_is_exact_in_nine_bytes() -> None:
    """Errata 003-5, L5: nothing wrong on smooth horizons and on the elevation model."""
    assert errors(Code(LAYOUT), dem_x4()) == (0.0, 0.0)
    assert errors(Code(LAYOUT), horizons(LAYOUT, 300)) == (0.0, 0.0)


def test_seventeen_bytes_hold_the_finer_land() -> None:
    layout = hemisphere_of(513)
    masks = horizons(layout, 300)
    code = Code(layout, 17)
    # One of 16 rows has no code of its own.
    assert (judged(code, code.encode(masks)) != masks).mean() < 2e-3
    half = Code(layout, 9)
    assert 2e-3 < (judged(half, half.encode(masks)) != masks).mean() < 0.04


def test_all_dark_and_all_lit() -> None:
    for count in (129, 513):
        layout = hemisphere_of(count)
        even = np.stack([np.zeros(count, bool), np.ones(count, bool)])
        code = Code(layout)
        np.testing.assert_array_equal(judged(code, code.encode(even)), even)


def test_what_hangs_over_a_point_counts_as_a_wall() -> None:
    mask = np.ones((1, 129), bool)
    mask[0, 5 * 16 : 7 * 16] = False  # a band of two rows
    code = Code(LAYOUT)
    words = code.encode(mask)
    wrong = judged(code, words) != mask
    assert wrong.sum() == 32  # no horizon at all is the better of two errors
    assert get(words, 64, 1)[0] == 1


@pytest.mark.parametrize("size", SECTORS)
@pytest.mark.parametrize("count", [129, 513])
def test_glsl_reads_as_numpy(see: Callable, size: int, count: int) -> None:
    layout = hemisphere_of(count)
    code, given = Code(layout, size), towards(300)
    words = code.encode(caps(layout, 300))
    assert np.abs(see(HorizonRing(size=size), layout, words, given) - twin(code, words, given)).max() < ARC


@pytest.mark.parametrize(
    ("right", "wrong"),
    [("4 * sector, 4", "4 * sector + 1, 4"), ("horizon + 0.5", "horizon + 1.0")],
)
def test_a_wrong_ring_is_found(see: Callable, spoil: Callable, right: str, wrong: str) -> None:
    code, given = Code(LAYOUT), towards(300)
    words = code.encode(caps(LAYOUT, 300))
    with spoil(FILE, right, wrong):
        assert np.abs(see(HorizonRing(), LAYOUT, words, given) - twin(code, words, given)).max() > 0.1
