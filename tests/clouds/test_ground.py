"""Where rays meet the land: against a walk in steps of metres, and a scout that leaps too far."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from renderer.clouds.land import tops
from renderer.clouds.renderer import CloudsRenderer
from renderer.clouds.state import CloudsState
from renderer.clouds.world_scale import LAND_CELL
from renderer.session import Session
from renderer.world.camera import rays

SIZE = (40, 30)
STEP, FARTHEST = 5.0, 16_000.0
SETS: dict[str, Any] = {"bounce.kind": "none", "phase.kind": "rayleigh", "scattering.kind": "delta_eddington",
                        "camera": {"kind": "look", "eye": [-6000, -7000, 1200], "target": [0, 0, 900],
                                   "field_of_view": 55}, "land": {"kind": "built_in", "relief": 2.0}}


@pytest.fixture(scope="module")
def session() -> Iterator[Session]:
    with Session() as opened:
        yield opened


@pytest.fixture(scope="module")
def state(session: Session) -> CloudsState:
    made = session.state("clouds", None, SETS)
    session.prepare(made).future.result()
    assert isinstance(made, CloudsState)
    return made


def traced(session: Session, state: CloudsState) -> np.ndarray:
    """Distance to the ground of each pixel's centre, (H, W), below 0 where there is none."""

    def draw(gl: Any) -> np.ndarray:
        drawer = CloudsRenderer(gl)
        try:
            texture = drawer.prepare(state, session._arrays(state), SIZE, (0.5, 0.5), 0)[1]["traced_ground"]
            return np.frombuffer(texture.read(), np.float32).reshape(SIZE[1], SIZE[0], 4)[::-1, :, 0]
        finally:
            drawer.release()
            gl.forget(drawer._baked)
            gl.forget(drawer._moment)

    return session.gl.call(draw)


@pytest.fixture(scope="module")
def walked(session: Session, state: CloudsState) -> np.ndarray:
    """The same by steps of metres in float64, infinite where no land is met."""
    height = np.asarray(session._arrays(state)["land"].arrays["height"], np.float64)
    origins, directions = rays(state.camera, *SIZE)
    radius, found = state.planet.radius, np.full(SIZE[::-1], np.inf)
    for t in np.arange(0.0, FARTHEST, STEP):
        point = origins + t * directions
        from_centre = point + [0, 0, radius]
        distance = np.linalg.norm(from_centre, axis=-1)
        place = point[..., :2] * (2 * radius / (distance + from_centre[..., 2]))[..., None]
        at = np.clip(place / LAND_CELL + len(height) / 2 - 0.5, 0, len(height) - 1.001)
        column, row = at[..., 0].astype(int), at[..., 1].astype(int)
        u, v = at[..., 0] - column, at[..., 1] - row
        low = height[row, column] * (1 - u) + height[row, column + 1] * u
        high = height[row + 1, column] * (1 - u) + height[row + 1, column + 1] * u
        below = distance - radius <= low * (1 - v) + high * v
        found = np.where(below & np.isinf(found), t, found)
    return found


def missed(session: Session, state: CloudsState, walked: np.ndarray) -> float:
    """Share of the rays over the land that meet it elsewhere, by more than a hundredth of the way and half a cell."""
    near = np.isfinite(walked) & (walked < 0.9 * FARTHEST)
    found = traced(session, state)
    return float(np.mean(np.abs(found - walked)[near] > 0.01 * walked[near] + LAND_CELL / 2))


def test_rays_meet_the_land_where_a_walk_does(session: Session, state: CloudsState, walked: np.ndarray) -> None:
    assert np.isfinite(walked).mean() > 0.4
    assert missed(session, state, walked) < 0.01


def test_a_scout_that_goes_too_far_is_found(
    session: Session, state: CloudsState, walked: np.ndarray, spoil: Callable
) -> None:
    with spoil("clouds/ground.glsl", "0.985 * nearest", "1.2 * nearest"):
        assert missed(session, state, walked) > 0.05


def test_no_node_is_higher_than_the_tops_above_it() -> None:
    height = np.random.default_rng(4).uniform(0, 100, (16, 16))
    levels = tops(height)
    assert [len(level) for level in levels] == [16, 8, 4, 2, 1]
    for number, level in enumerate(levels):
        wide = np.kron(level, np.ones((2**number, 2**number)))
        assert (wide >= height.astype(np.float32)).all()
    assert levels[-1][0, 0] == np.float32(height.max())
