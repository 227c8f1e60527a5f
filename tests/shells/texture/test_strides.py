"""Few bytes a voxel: as right as they can be, and never farther than to the nearest other matter."""

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


def coded(opacity: np.ndarray) -> np.ndarray:
    return strides.coded(baked(opacity), [opacity])[0].astype(int)


@pytest.mark.parametrize("opacity", [0.0002, 0.03, 0.4, 0.9998, 1.0])
def test_two_bytes_hold_an_opacity(opacity: float) -> None:
    code = coded(np.full(SHAPE, opacity, np.float32))
    found = (code[..., 0] - strides.FIRST + code[..., 1] / 255) / (255 - strides.FIRST)
    np.testing.assert_allclose(found, opacity, atol=1.3e-5)


def test_nothing_tells_how_far_matter_is() -> None:
    opacity = np.zeros(SHAPE, np.float32)
    opacity[3, 5, 20] = opacity[12, 20, 2] = 0.8
    code, away = coded(opacity), distances(opacity > 0, "repeat")
    nothing = opacity == 0
    told = 1 + (strides.FIRST - code[..., 0]) / strides.PER_VOXEL
    np.testing.assert_array_equal(told[nothing], away[nothing])
    assert (code[~nothing, 0] >= strides.FIRST).all()
    assert not code[nothing, 1].any()


def test_faint_matter_tells_how_far_all_else_is() -> None:
    opacity = np.full(SHAPE, 0.02, np.float32)
    opacity[8, 12, 12] = 0.9
    away = np.minimum(distances(opacity > 0.5, "repeat"), strides.FARTHEST_FAINT).astype(int)
    np.testing.assert_array_equal(coded(opacity)[..., 2], strides.PER_FAINT * np.maximum(away - 2, 0))
    assert not baked(opacity, reference_length=0.1)["faint"].any(), "a voxel's own depth is unknown"


def test_coarser_levels_keep_their_distance() -> None:
    rng = np.random.default_rng(3)
    matter = np.zeros((*SHAPE, 4), np.float32)
    matter[tuple(rng.integers(0, side, 6) for side in SHAPE)] = 1.0
    levels = [level.matter for level in mean_pyramid(Extinct(matter, matter))]
    assert len(levels) > 2
    numbers = [level[..., 3] for level in levels]
    for number, code in zip(numbers, strides.coded(baked(-np.expm1(-matter[..., 3])), numbers), strict=True):
        nothing = number == 0
        told = 1 + (strides.FIRST - code[..., 0].astype(int)) / strides.PER_VOXEL
        assert (code[~nothing, 0] >= strides.FIRST).all()
        assert (told[nothing] <= np.maximum(distances(~nothing, "repeat"), 1)[nothing]).all()
