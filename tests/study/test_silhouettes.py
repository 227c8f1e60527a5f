"""Distances of outlines, on discs and squares made by hand."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.core.errors import InputError
from renderer.study.silhouettes import apart, away, outline


def disc(x: float, y: float, radius: float, size: int = 96) -> np.ndarray:
    """Coverage of a disc, its edge a pixel wide; linear between pixels, its outline is off by up to a tenth."""
    row, column = np.mgrid[0:size, 0:size]
    return np.clip(radius - np.hypot(column - x, row - y) + 0.5, 0, 1)


def test_an_outline_lies_where_half_is_covered() -> None:
    found = outline(disc(47.3, 48.1, 30.25))
    assert np.hypot(found[:, 0] - 47.3, found[:, 1] - 48.1) == pytest.approx(np.full(len(found), 30.25), abs=0.1)
    assert 0.25 * len(found) == pytest.approx(2 * np.pi * 30.25, rel=0.01)


def test_a_wider_disc_is_off_by_its_width_everywhere() -> None:
    found = apart(disc(48, 48, 33.5), disc(48, 48, 30))
    assert [found.median, found.p95, found.worst] == pytest.approx([3.5, 3.5, 3.5], abs=0.2)
    assert found.length == pytest.approx(2 * np.pi * 30, rel=0.01)
    assert apart(disc(48, 48, 30), disc(48, 48, 30)).worst == 0


def test_a_disc_that_moved_is_off_by_the_share_across_its_edge() -> None:
    """|cos| of a shift of 3 has median 3 sin(45 degrees)."""
    found = apart(disc(51, 48, 30), disc(48, 48, 30))
    assert found.median == pytest.approx(3 * np.sin(np.pi / 4), abs=0.1)
    assert found.worst == pytest.approx(3, abs=0.1)


def test_what_is_missing_counts_as_what_is_drawn_beyond() -> None:
    two = np.maximum(disc(28, 48, 12), disc(75, 48, 6))
    missing, beyond = apart(disc(28, 48, 12), two), apart(two, disc(28, 48, 12))
    assert missing.worst == beyond.worst == pytest.approx(81 - 40, abs=0.2)
    assert missing.p95 > 30


def test_nothing_drawn_is_as_far_as_can_be() -> None:
    assert apart(np.zeros((96, 96)), disc(48, 48, 30)).median == pytest.approx(np.hypot(96, 96))
    with pytest.raises(InputError, match="silhouette"):
        apart(disc(48, 48, 30), np.zeros((96, 96)))
    with pytest.raises(InputError, match="shape"):
        apart(np.zeros((4, 4)), np.zeros((4, 5)))
    with pytest.raises(InputError, match="alpha"):
        outline(np.zeros(4))


def test_away_from_a_silhouette() -> None:
    alpha = disc(48, 48, 30)
    row, column = np.mgrid[0:96, 0:96]
    radius = np.hypot(column - 48, row - 48)
    inside = away(alpha, 4)
    assert inside[radius < 24.5].all()
    assert not inside[radius > 26].any()
    assert away(np.ones((5, 5)), 4).all()
