"""Where the reference lets a ray go."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.reference.forest_march import ALL, COLUMNS, GROUND, LEFT, march
from renderer.reference.forest_world import prepare
from tests.reference.worlds import flat


@pytest.mark.parametrize(("reach", "reached"), [(39.0, LEFT), (41.0, GROUND)])
def test_nothing_is_met_beyond_the_reach(reach: float, reached: int) -> None:
    scene = prepare(flat(0, reach=reach))
    record = np.empty((0, COLUMNS))
    status, s, _, _ = march(
        scene, (0.0, 0.0, 40.0), (0.0, 0.0, -1.0), 0.0, 0.0, 1e9, 0.1, True, ALL, (0.0, 0.0), record
    )
    assert status == reached
    assert s == pytest.approx(min(reach, 40.0))
