"""No order: right where a depth buffer is enough, wrong where matter lets light through."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.shells.order.none import veiled
from tests.shells.conftest import even
from tests.shells.order.test_walk import GLOBE
from tests.shells.order.worlds import absorber_error, difference, ordered, two_layers

Draw = Callable[..., np.ndarray]
FILE = "shells/order/none.glsl"
BLENDED = ordered("none", depth=False)


def opaque_rows() -> np.ndarray:
    """Opaque matter in two colours with air between, cut off sharply at the voxels."""
    block = even(1.0, layers=4)
    block[:, :, 1::2, 3] = 0
    block[2:, ..., :3] = (1, 0.2, 0)
    return block


def wrong(draw: Draw, order: dict) -> float:
    """Share of pixels of opaque matter that differ from the walk's."""
    world = {**GLOBE, "voxels": {"interpolation": "nearest", "storage": "float", "density": 60.0}}
    block = opaque_rows()
    gap = np.abs(draw({**world, **order}, block, size=32) - draw(world, block, size=32)).max(axis=-1)
    return float((gap > 0.02).mean())


def test_the_depth_buffer_is_enough_for_opaque_matter(draw: Draw) -> None:
    assert wrong(draw, ordered("none")) < 0.02  # what is left are cells crossed too shortly to be opaque


def test_even_opacity_needs_no_order(draw: Draw) -> None:
    assert absorber_error(draw, BLENDED) < 1e-5


def test_it_is_wrong_for_semi_transparent_matter(draw: Draw) -> None:
    assert two_layers(draw, BLENDED) != pytest.approx([0.6, 0.0, 0.24, 0.84], abs=0.1)
    assert (difference(draw, BLENDED, GLOBE) > 0.01).mean() > 0.2


def test_it_says_how_much_matter_lets_light_through() -> None:
    half = opaque_rows()
    assert veiled(half) == 0
    half[0, ..., 3] *= 0.5
    assert veiled(half) == pytest.approx(0.25)


def test_a_depth_buffer_that_hides_all_is_found(draw: Draw, spoil: Callable) -> None:
    with spoil(FILE, "if (sum.a < order_cut) discard;", "sum.a = max(sum.a, 1.0e-6);"):
        assert wrong(draw, ordered("none")) > 0.1
