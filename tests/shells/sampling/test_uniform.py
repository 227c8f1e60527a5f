"""Uniform samples: right in even matter, first voxels missed by large steps, and what goes wrong without correction."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from tests.shells.conftest import even, sigma

Draw = Callable[..., np.ndarray]
FILE = "shells/sampling/uniform.glsl"


def opacity(draw: Draw, samples: float, correction: bool = True, block: np.ndarray | None = None) -> float:
    sampling = {"kind": "uniform", "samples": samples, "correction": correction}
    block, length = (even(0.1), 0.1) if block is None else (block, 0.5 / len(block))
    return float(draw({"sampling": sampling}, block, reference_length=length)[4, 4, 3])


def test_even_matter_whatever_the_number(draw: Draw) -> None:
    exact = 1 - np.exp(-sigma(0.1) * 0.5)
    assert [opacity(draw, n) for n in (1, 3, 20)] == pytest.approx([exact] * 3, abs=1e-4)


def test_without_correction_more_samples_are_more_opaque(draw: Draw) -> None:
    """The failure of erratum 002-4: opacity depends on the number of steps."""
    few, many = opacity(draw, 2, correction=False), opacity(draw, 20, correction=False)
    assert many - few > 0.3


def test_a_thin_layer_is_missed_by_large_steps(draw: Draw) -> None:
    """Dufort 2005, figure 5.3."""
    few, many = [], []
    for low in range(4, 60, 8):
        block = even(0.0, layers=64)
        block[low : low + 2, ..., 3] = 0.9999
        few.append(opacity(draw, 1, block=block))
        many.append(opacity(draw, 64, block=block))
    assert min(few) < 0.1 < 0.9 < min(many)


@pytest.mark.parametrize(
    ("right", "wrong"),
    [("lambda += share;", "lambda += 0.5 * share;"), ("sum += (1.0 - sum.a) * alpha", "sum += alpha")],
)
def test_wrong_steps_and_weights_are_found(draw: Draw, spoil: Callable, right: str, wrong: str) -> None:
    with spoil(FILE, right, wrong):
        assert abs(opacity(draw, 20) - (1 - np.exp(-sigma(0.1) * 0.5))) > 0.02
