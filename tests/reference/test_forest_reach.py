"""Where the reference lets a ray go."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.core.errors import InputError
from renderer.reference.forest import Options, render
from renderer.reference.forest_march import ALL, COLUMNS, GROUND, LEFT, march
from renderer.reference.forest_world import prepare
from tests.reference.worlds import CENTRE, flat, looking


@pytest.mark.parametrize(("reach", "reached"), [(39.0, LEFT), (41.0, GROUND)])
def test_nothing_is_met_beyond_the_reach(reach: float, reached: int) -> None:
    scene = prepare(flat(0, reach=reach))
    record = np.empty((0, COLUMNS))
    status, s, _, _ = march(
        scene, (0.0, 0.0, 40.0), (0.0, 0.0, -1.0), 0.0, 0.0, 1e9, 0.1, True, ALL, (0.0, 0.0), record
    )
    assert status == reached
    assert s == pytest.approx(min(reach, 40.0))


@pytest.mark.parametrize("alpha", [0, 40], ids=["meadow", "canopy"])
def test_what_lies_beyond_the_square_fades_into_what_is_behind(alpha: int) -> None:
    """Closed form: kept x what the same land sends inside + (1 - kept) x behind, kept = exp(-(distance / fade)^2)."""
    behind = np.array([5.0, 6.0, 7.0])
    world = flat(alpha, fade=80.0, background=lambda directions: np.broadcast_to(behind, directions.shape))
    half = 16 * world.cell
    points = [[0.0, 0.0], [half, half], [half + 40.0, 10.0], [-half - 30.0, -half - 40.0], [half + 500.0, 0.0]]
    found = render(world, looking(points), CENTRE, Options(shadow_rays=0)).radiance[0]
    kept = np.exp(-((np.array([0, 0, 40.0, 50.0, 500.0]) / 80.0) ** 2))
    np.testing.assert_allclose(found[:, 3], kept, atol=1e-12)
    np.testing.assert_allclose(found[:, :3], kept[:, None] * found[0, :3] + (1 - kept[:, None]) * behind, rtol=1e-9)


def test_the_length_of_the_fading_must_be_one() -> None:
    with pytest.raises(InputError) as failure:
        flat(0, fade=0.0)
    assert failure.value.field == "fade"
