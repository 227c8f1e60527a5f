"""No bounce: no light is added."""

from __future__ import annotations

import numpy as np

from renderer.clouds.bounce.none import NoBounce
from tests.clouds.bounce.conftest import Shown, middles, uneven


def test_nothing_is_added_anywhere(shown: Shown) -> None:
    solved = NoBounce().solve(uneven(), None, {})
    assert not solved.added.ground.any()
    assert not solved.added.cloud.any()
    places = np.concatenate([middles()[0][::50], [[1e6, 0.0]]])
    for found in shown(NoBounce(), None, solved, places):
        assert (found == 0).all()
