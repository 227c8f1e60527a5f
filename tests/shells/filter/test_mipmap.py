"""Mip levels: a far board has its mean brightness, a near one its cells, and thin columns keep their share."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from tests.shells.filter.boards import board, contrast

Draw = Callable[..., np.ndarray]
MIPMAP = {"kind": "mipmap", "bias": 0.0}


def near(draw: Draw) -> float:
    """Contrast of the board where a pixel is a little wider than a voxel."""
    camera = {"kind": "orthographic", "centre": [0, 0, 0], "direction": [0, 0, -1], "up": [0, 1, 0], "width": 0.55}
    return float(2 * draw({"filter": MIPMAP, "camera": camera}, board(), size=16)[..., 0].std())


def test_a_far_board_is_grey(draw: Draw) -> None:
    assert contrast(draw, MIPMAP, board()) < 0.05


def test_a_near_board_is_not(draw: Draw) -> None:
    assert near(draw) > 0.5


def test_plates_keep_the_share_that_they_cover(draw: Draw) -> None:
    """Of opaque plates over a quarter of the ground a quarter is seen from afar: opacities are averaged, not matter."""
    block = np.zeros((8, 64, 64, 4), np.float32)
    block[..., :3] = 1.0
    block[3, ::2, ::2, 3] = 0.9999
    camera = {"kind": "orthographic", "centre": [0, 0, 0], "direction": [0, 0, -1], "up": [0, 1, 0], "width": 1.6}
    found = draw({"filter": MIPMAP, "camera": camera}, block, reference_length=0.5 / 8, size=6)
    assert float(found[..., 3].mean()) == pytest.approx(0.25, abs=0.02)


def test_columns_stay_as_thin_as_they_are(draw: Draw) -> None:
    """Upright columns over a sixteenth of the ground: seen from afar and above they hide a sixteenth by the light from
    above, and more by opacities that are put together as if by chance."""
    block = np.zeros((8, 64, 64, 4), np.float32)
    block[..., :3] = 1.0
    block[:, ::4, ::4, 3] = 0.9999
    camera = {"kind": "orthographic", "centre": [0, 0, 0], "direction": [0, 0, -1], "up": [0, 1, 0], "width": 1.6}
    found = {}
    for levels in ("above", "thesis", "mean"):
        change = {"filter": {**MIPMAP, "levels": levels, "bias": -1.0}, "camera": camera}
        found[levels] = float(draw(change, block, reference_length=0.5 / 8, size=6)[..., 3].mean())
    assert found["above"] == pytest.approx(1 / 16, rel=0.05)
    assert found["thesis"] > 1.3 / 16
    assert found["mean"] > found["thesis"]


@pytest.mark.parametrize(
    ("right", "wrong"), [("pixel_width(distance) * widest", "widest"), ("0.0, filter_coarsest)", "0.0, 0.0)")]
)
def test_a_wrong_width_is_found(draw: Draw, spoil: Callable, right: str, wrong: str) -> None:
    with spoil("shells/footprint.glsl", right, wrong):
        assert near(draw) < 0.3 or contrast(draw, MIPMAP, board()) > 0.2
