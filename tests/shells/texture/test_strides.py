"""A byte a voxel: right in the mean, and never farther than to the nearest other matter."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.shells.texture import strides
from renderer.shells.texture.extinction import Extinct
from renderer.shells.texture.occupancy import distances
from renderer.shells.texture.pyramid import mean_pyramid

SHAPE = (16, 24, 24)


def baked(opacity: np.ndarray, reference_length: float = 0.0) -> dict[str, np.ndarray]:
    made = {"colour": np.repeat(opacity[..., None], 4, axis=-1), "reference_length": np.array(reference_length)}
    return strides.bake_strides({"wrap": "repeat"}, {"texture": made}, lambda share, words: None)


def coded(extinction: np.ndarray) -> np.ndarray:
    found = baked(-np.expm1(-extinction))
    return strides.coded(found, [np.repeat(extinction[..., None], 4, axis=-1)])[0].astype(float)


def told(code: np.ndarray) -> np.ndarray:
    """Extinction of a reference length, as the shader reads it."""
    faint = np.sqrt(strides.FAINT / strides.DENSEST) * (code - strides.FIRST_FAINT) / (
        strides.FIRST_OTHER - 1 - strides.FIRST_FAINT)  # fmt: skip
    other = (code - strides.FIRST_OTHER) / (255 - strides.FIRST_OTHER)
    root = np.where(code < strides.FIRST_FAINT, 0.0, np.where(code < strides.FIRST_OTHER, faint, other))
    return root**2 * strides.DENSEST


@pytest.mark.parametrize("extinction", [0.002, 0.03, 0.07, 1.234, 8.0])
def test_bytes_are_right_in_the_mean(extinction: float) -> None:
    code = coded(np.full(SHAPE, extinction, np.float32))
    assert told(code).mean() == pytest.approx(extinction, rel=0.004)
    assert np.ptp(code) <= 1
    assert ((code < strides.FIRST_OTHER) == (extinction < strides.FAINT)).all()


def test_nothing_tells_how_far_matter_is() -> None:
    extinction = np.zeros(SHAPE, np.float32)
    extinction[3, 5, 20] = extinction[12, 20, 2] = 2.0
    code = coded(extinction)
    np.testing.assert_array_equal(code[extinction == 0], distances(extinction > 0, "repeat")[extinction == 0])
    assert (code[extinction > 0] >= strides.FIRST_OTHER).all()


def test_faint_matter_keeps_away_from_all_else() -> None:
    extinction = np.full(SHAPE, 0.02, np.float32)
    extinction[8, 12, 12] = 3.0
    code = coded(extinction)
    far = distances(extinction > 1, "repeat") >= strides.STRIDE
    assert far.any()
    assert not far.all()
    np.testing.assert_array_equal(code < strides.FIRST_OTHER, far)
    assert not baked(-np.expm1(-extinction), reference_length=0.1)["faint"].any(), "a voxel's own depth is unknown"


def test_coarser_levels_keep_their_distance() -> None:
    rng = np.random.default_rng(3)
    matter = np.zeros((*SHAPE, 4), np.float32)
    matter[tuple(rng.integers(0, side, 6) for side in SHAPE)] = 1.0
    levels = [level.matter for level in mean_pyramid(Extinct(matter, matter))]
    assert len(levels) > 2
    for level, code in zip(levels, strides.coded(baked(-np.expm1(-matter[..., 3])), levels), strict=True):
        nothing = level[..., 3] == 0
        assert (code[~nothing] >= strides.FIRST_FAINT).all()
        assert (code[nothing] >= 1).all()
        assert (code[nothing] <= np.maximum(distances(~nothing, "repeat"), 1)[nothing]).all()
