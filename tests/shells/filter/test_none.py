"""Without a filter the finest voxels are read, from however far."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from tests.shells.filter.boards import board, contrast

Draw = Callable[..., np.ndarray]


def test_a_far_board_keeps_its_contrast(draw: Draw) -> None:
    assert contrast(draw, {"kind": "none"}, board()) > 0.5


def test_a_coarser_level_would_be_found(draw: Draw, spoil: Callable) -> None:
    """Only the one level is on the GPU, so a shifted place stands for it: the board's own mean."""
    with spoil("shells/filter/none.glsl", "return 0.0;", "return 5.0;"):
        assert contrast(draw, {"kind": "none"}, board()) > 0.5, "no level is there to be read by mistake"
