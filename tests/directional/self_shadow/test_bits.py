"""Bits: each direction exactly, what is between blended or nearest, and the same in GLSL."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.directional.codes.bits import Bits as Code
from renderer.directional.codes.code import decode
from renderer.directional.hemisphere import hemisphere_of
from renderer.directional.self_shadow.bits import Bits
from tests.directional.self_shadow.conftest import ARC, caps, towards, twin

FILE = "directional/self_shadow/bits.glsl"


@pytest.mark.parametrize("blend", [True, False])
@pytest.mark.parametrize("count", [33, 129, 513])
def test_each_direction_is_kept(count: int, blend: bool) -> None:
    layout = hemisphere_of(count)
    masks = caps(layout, 50)
    code = Code(layout, blend)
    words = code.encode(masks)
    assert words.shape == (50, -(-count // 32))
    assert code.size == -(-count // 8)  # 17 bytes for 129
    np.testing.assert_allclose(decode(code, words), masks, atol=1e-12)


@pytest.mark.parametrize("blend", [True, False])
@pytest.mark.parametrize("count", [129, 513])
def test_glsl_reads_as_numpy(see: Callable, count: int, blend: bool) -> None:
    layout = hemisphere_of(count)
    code, given = Code(layout, blend), towards(400)
    words = code.encode(caps(layout, 400))
    error = np.abs(see(Bits(blend=blend), layout, words, given) - twin(code, words, given))
    # By Mesa's arc sine a row may be another where a direction falls on its edge.
    assert np.sort(error)[-1 if blend else -4] < ARC


def test_directions_themselves_are_exact_in_glsl(see: Callable) -> None:
    layout = hemisphere_of(129)
    masks = caps(layout, 129)
    seen = see(Bits(), layout, Code(layout).encode(masks), layout.directions())
    np.testing.assert_allclose(seen, masks[np.arange(129), np.arange(129)], atol=ARC)


@pytest.mark.parametrize(
    ("right", "wrong"), [("number >> 5", "number >> 4"), ("first.x + 1, first.y)", "first.x, first.y)")]
)
def test_a_wrong_cell_is_found(see: Callable, spoil: Callable, right: str, wrong: str) -> None:
    layout, given = hemisphere_of(129), towards(200)
    words = Code(layout).encode(caps(layout, 200))
    with spoil(FILE, right, wrong):
        assert np.abs(see(Bits(), layout, words, given) - twin(Code(layout), words, given)).max() > 0.1
