"""Errors of order, on pictures made by hand."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.shells.order_errors import order_error


def plain() -> np.ndarray:
    """Ten by ten pixels of light 4, half of them empty."""
    picture = np.zeros((10, 10, 4), np.float32)
    picture[:5] = (4, 4, 4, 0.8)
    return picture


def test_equal_pictures_have_no_error() -> None:
    found = order_error(plain(), plain())
    assert (found.wrong, found.relative_rmse, found.worst) == (0, 0, 0)


def test_wrong_pixels_are_counted_among_those_that_show_matter() -> None:
    picture = plain()
    picture[0, :5, 0] += 4 * 0.01
    picture[1, :, 1] += 4 * 0.003
    found = order_error(picture, plain())
    assert found.wrong == pytest.approx(5 / 50)
    assert found.worst == pytest.approx(0.01, rel=1e-4)
    assert order_error(picture, plain(), 0.001).wrong == pytest.approx(15 / 50)


def test_matter_where_none_should_be_is_wrong() -> None:
    picture = plain()
    picture[9, 0, 3] = 0.5
    assert order_error(picture, plain()).wrong == pytest.approx(1 / 51)


def test_relative_rmse_is_of_light() -> None:
    assert order_error(1.1 * plain(), plain()).relative_rmse == pytest.approx(0.1, rel=1e-5)


def test_an_empty_picture_has_no_error() -> None:
    empty = np.zeros((4, 4, 4), np.float32)
    assert order_error(empty, empty).wrong == 0
