"""Bits: each direction exactly, what is between blended or nearest, and the same in GLSL."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.core.errors import LimitError
from renderer.core.params import validate
from renderer.directional.bakes import bakes
from renderer.directional.codes.bits import Bits as Code
from renderer.directional.codes.code import decode
from renderer.directional.hemisphere import hemisphere_of
from renderer.directional.self_shadow.bits import Bits
from renderer.directional.state import DirectionalState
from tests.directional.self_shadow.conftest import ARC, caps, towards, twin

FILE = "directional/self_shadow/bits.glsl"


@pytest.mark.parametrize("blend", [True, False])
@pytest.mark.parametrize("count", [33, 129, 513, 2049])
def test_each_direction_is_kept(count: int, blend: bool) -> None:
    layout = hemisphere_of(count)
    masks = caps(layout, 50)
    code = Code(layout, blend)
    words = code.encode(masks)
    assert words.shape == (50, -(-count // 32))
    assert code.size == -(-count // 8)  # 17 bytes for 129
    np.testing.assert_allclose(decode(code, words), masks, atol=1e-12)


@pytest.mark.parametrize("blend", [True, False])
@pytest.mark.parametrize("count", [129, 513, 2049])
def test_glsl_reads_as_numpy(see: Callable, count: int, blend: bool) -> None:
    layout, technique = hemisphere_of(count), Bits(blend=blend)
    code, given = Code(layout, blend, technique.sharpness), towards(400)
    words = code.encode(caps(layout, 400))
    error = np.abs(see(technique, layout, words, given) - twin(code, words, given))
    # By Mesa's arc sine a row may be another where a direction falls on its edge.
    assert np.sort(error)[-1 if blend else -4] < ARC


def test_directions_themselves_are_exact_in_glsl(see: Callable) -> None:
    layout = hemisphere_of(129)
    masks = caps(layout, 129)
    seen = see(Bits(), layout, Code(layout).encode(masks), layout.directions())
    np.testing.assert_allclose(seen, masks[np.arange(129), np.arange(129)], atol=ARC)


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("number >> 5", "number >> 4"),
        ("first.x + 1, first.y)", "first.x, first.y)"),
        ("self_shadow_sharpness * (mix", "(mix"),
    ],
)
def test_a_wrong_cell_is_found(see: Callable, spoil: Callable, right: str, wrong: str) -> None:
    layout, given = hemisphere_of(129), towards(200)
    words = Code(layout).encode(caps(layout, 200))
    with spoil(FILE, right, wrong):
        right_ = twin(Code(layout, sharpness=Bits().sharpness), words, given)
        assert np.abs(see(Bits(), layout, words, given) - right_).max() > 0.1


def test_a_sharper_edge_lies_where_the_blend_is_a_half() -> None:
    """A straight edge between directions, rows 4 and up lit: the blend climbs from 3.5 to 4.5 rows above the horizon,
    steeper by the sharpness about its middle."""
    layout = hemisphere_of(129)
    masks = np.append(np.repeat(np.arange(layout.elevations) >= 4, layout.azimuths), True)[None]
    places = np.stack([np.linspace(3.3, 4.7, 57), np.full(57, 2.25)], axis=1)
    for sharpness in (1.0, 2.0, 8.0):
        code = Code(layout, sharpness=sharpness)
        found = code.evaluate(code.encode(masks), places)[0]
        np.testing.assert_allclose(found, np.clip(0.5 + sharpness * (places[:, 0] - 4), 0, 1), atol=1e-9)


def test_the_finest_hemispheres_are_for_bits_alone() -> None:
    document = {"scene": "directional", "hemispheres": {"directions": 2049}}
    kept = bakes(validate(DirectionalState, document))
    assert next(bake for bake in kept if bake.name == "shadows").arguments["directions"] == 2049
    with pytest.raises(LimitError, match=r"hemispheres\.directions"):
        bakes(validate(DirectionalState, {**document, "self_shadow": {"kind": "horizon_ring"}}))
