"""The land round the site: what its slopes see of the sky."""

from __future__ import annotations

import math

import numpy as np
import pytest

from renderer.clouds import land
from renderer.clouds.world_scale import LAND_CELL, LAND_NODES


def opened(height: np.ndarray) -> np.ndarray:
    return land._open(height, land._horizons(height, lambda share, words: None))


@pytest.mark.parametrize("slope", [0.0, 20.0, 45.0])
def test_a_plane_sees_the_sky_as_far_as_it_lies_level(slope: float) -> None:
    """Half of 1 + cos S of an even sky (Dozier and Frew 1990, section III)."""
    rise = math.tan(math.radians(slope)) * np.arange(LAND_NODES) * LAND_CELL
    found = opened(np.broadcast_to(rise, (LAND_NODES, LAND_NODES)))
    middle = found[100:156, 200:220]  # far below the crest, whose own height hides nothing of it
    assert middle == pytest.approx(0.5 * (1 + math.cos(math.radians(slope))), abs=0.015)


def test_the_foot_of_a_wall_sees_half_of_the_sky() -> None:
    height = np.zeros((LAND_NODES, LAND_NODES))
    height[:, 300:] = 20000.0
    assert opened(height)[128, 148] == pytest.approx(0.5, abs=0.02)


def test_a_summit_hides_the_sun_from_the_layer_behind_it() -> None:
    """A needle that stands 400 m out of the layer, 2 km to the east under an eastern sun: its sine is known."""
    height = np.zeros((LAND_NODES, LAND_NODES), np.float32)
    height[256:258, 256:258] = 1400.0
    made = {"height": height, "top": np.array(1400.0)}
    found = land.horizon_of_layer(made, np.pi / 2, 1000.0)
    assert found[128, 128 - 20] == pytest.approx(np.sin(np.arctan(400 / 2000)), rel=0.02)
    assert found[128, 128 + 20] == -1.0, "nothing in the east of it"
    assert found[128 - 40, 128 - 20] == -1.0
    assert (land.horizon_of_layer(made, np.pi / 2, 1500.0) == -1.0).all(), "a layer above all summits"
