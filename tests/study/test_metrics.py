"""Each metric on arrays small enough to work out by hand."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.core.errors import InputError
from renderer.study.metrics import best_gain, error_map, flip, relative_rmse, stained


def test_relative_rmse_by_hand() -> None:
    reference = np.zeros((1, 2, 3))
    reference[0, 0] = 1.0
    reference[0, 1] = 3.0
    image = reference.copy()
    image[0, 1, 0] = 5.0
    # one squared error of 4 among 6 values, over a mean of 2
    assert relative_rmse(image, reference) == pytest.approx(np.sqrt(4 / 6) / 2, rel=1e-12)


def test_relative_rmse_divides_by_the_reference_and_ignores_alpha() -> None:
    reference = np.full((2, 2, 4), 2.0)
    image = np.full((2, 2, 4), 3.0)
    image[..., 3] = 90.0
    assert relative_rmse(image, reference) == pytest.approx(0.5)
    # swapped arguments divide by the other mean: a metric normalised by the image would pass above and fail here
    assert relative_rmse(reference[..., :3], image[..., :3]) == pytest.approx(1 / 3)


def test_relative_rmse_is_taken_in_double_precision() -> None:
    reference = np.full((64, 64, 3), 1.0, np.float32)
    image = reference + np.float32(2.0**-20)
    assert relative_rmse(image, reference) == pytest.approx(2.0**-20, rel=1e-9)


@pytest.mark.parametrize("image", [np.ones((2, 3, 3)), np.full((2, 2, 3), np.nan), np.ones((2, 2))])
def test_pictures_that_cannot_be_compared_are_refused(image: np.ndarray) -> None:
    with pytest.raises(InputError):
        relative_rmse(image, np.ones((2, 2, 3)))


def test_a_black_reference_is_refused() -> None:
    with pytest.raises(InputError, match="black"):
        relative_rmse(np.ones((2, 2, 3)), np.zeros((2, 2, 3)))


def test_stains_are_the_pixels_off_by_more_than_half_of_the_mean() -> None:
    exact = np.full((2, 5, 3), 2.0)
    image = exact.copy()
    image[0, :3, :] += [[1.1], [0.9], [-1.5]]
    image[1, 0] += [0.0, 0.0, 2.9]
    assert stained(image, exact) == pytest.approx(0.2), "by their mean over the channels"
    assert stained(image, exact, 0.4) == pytest.approx(0.4)


def test_best_gain_recovers_a_factor_and_is_least_squares() -> None:
    reference = np.random.default_rng(1).random((4, 4, 3))
    assert best_gain(reference / 1.7, reference) == pytest.approx(1.7)
    image = np.zeros((1, 2, 3))
    image[0, 0], image[0, 1] = 1.0, 2.0
    assert best_gain(image, np.ones((1, 2, 3))) == pytest.approx(3 / 5)


def test_flip_is_zero_for_equal_pictures_and_one_for_black_against_white() -> None:
    white = np.full((32, 32, 3), 255, np.uint8)
    assert flip(white, white).mean == 0
    far = flip(np.zeros_like(white), white)
    assert far.map.shape == (32, 32)
    # black on white is FLIP's largest colour difference by construction (Andersson et al. 2020, section 4)
    assert far.mean == pytest.approx(far.map.mean())
    assert far.mean > 0.95


def test_flip_p95_sees_a_patch_that_the_mean_dilutes() -> None:
    reference = np.full((64, 64, 3), 128, np.uint8)
    image = reference.copy()
    image[:, :8] = 255
    found = flip(image, reference)
    assert found.p95 > 4 * found.mean
    assert found.map[:, 40:].max() < 0.01, "pixels far from the patch are equal"
    assert found.map[32, 2] > 0.3


def test_flip_refuses_linear_floats() -> None:
    with pytest.raises(InputError, match="displayed"):
        flip(np.zeros((8, 8, 3)), np.zeros((8, 8, 3)))  # type: ignore[arg-type]


def test_error_map_scale_legend_and_saturation() -> None:
    reference = np.full((1, 4, 3), 2.0)
    image = reference.copy()
    image[0, 1] += 1.0
    image[0, 2] += 2.0
    image[0, 3] += 4.0
    found = error_map(image, reference, top=1.0)
    assert found.saturated == pytest.approx(0.25), "only the last pixel is above the top: 4 / 2 > 1"
    values = [value for value, _ in found.legend]
    assert values == pytest.approx([0, 0.25, 0.5, 0.75, 1])
    assert tuple(found.rgb8[0, 0]) == found.legend[0][1]
    assert tuple(found.rgb8[0, 2]) == found.legend[-1][1] == tuple(found.rgb8[0, 3])
    middle = found.legend[2][1]
    assert np.abs(found.rgb8[0, 1].astype(int) - middle).max() <= 4, "half the scale, within one of its 256 steps"


def test_error_map_of_equal_pictures_is_the_scale_bottom() -> None:
    found = error_map(np.ones((2, 2, 3)), np.ones((2, 2, 3)))
    assert (found.rgb8 == found.legend[0][1]).all()
    assert found.top > 0
