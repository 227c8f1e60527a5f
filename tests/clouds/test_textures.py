"""The clouds' pictures at coarser levels."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.clouds.textures import halved, with_slopes


@pytest.mark.parametrize("kind", [np.uint8, np.float16, np.float32])
def test_every_coarser_level_keeps_the_mean(kind: type) -> None:
    """Bytes must not run over as they are summed."""
    picture = np.random.default_rng(4).integers(100, 256, (64, 32, 3)).astype(kind)
    levels = halved(picture)
    assert [level.shape[:2] for level in levels] == [(32, 16), (16, 8), (8, 4), (4, 2), (2, 1)]
    for level in levels:
        assert level.mean(axis=(0, 1)) == pytest.approx(picture.astype(float).mean(axis=(0, 1)), rel=1e-5)


def test_open_sky_adds_nothing_to_the_mean_thickness() -> None:
    """Between clouds the map goes on below zero, for smooth edges; its last channel does not."""
    field = np.random.default_rng(5).standard_normal((16, 16)).astype(np.float32)
    made = with_slopes(field, 1600.0)
    assert np.array_equal(made[..., 0], field)
    assert np.array_equal(made[..., 3], np.maximum(field, 0))
    east = (np.roll(made[..., 3], -1, 1) - np.roll(made[..., 3], 1, 1)) / 200.0
    assert made[..., 1] == pytest.approx(east, abs=1e-6)
