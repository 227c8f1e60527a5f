"""Lambert's law by voxels: a level opaque layer in closed form, matter without normals, glow."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.core.baking import bake_now
from renderer.core.cache import Cache
from renderer.core.params import validate
from renderer.shells.bakes import sky_bake
from renderer.shells.state import ShellsState
from renderer.world.sky import sky_for
from tests.shells.conftest import even

Draw = Callable[..., np.ndarray]
ELEVATION = 30.0
SUN = {"kind": "direction", "azimuth": 90.0, "elevation": ELEVATION}
FILE = "shells/light/lambert.glsl"


def arriving() -> tuple[np.ndarray, np.ndarray]:
    """Irradiance of sun and sky, W m-2."""
    tables = bake_now(sky_bake(validate(ShellsState, {"scene": "shells"})), Cache())
    now = sky_for(tables, np.radians(ELEVATION))
    return np.asarray(now.sun_irradiance), np.asarray(now.sky_irradiance)


def seen(draw: Draw, normal: tuple[float, float, float], glow: float = 0.0) -> np.ndarray:
    block = even(0.9999, (0.5, 0.25, 1.0))
    normals = np.empty((*block.shape[:3], 4), np.float32)
    normals[:] = (*normal, glow)
    patch = {"light": {"kind": "lambert"}, "sun": SUN, "voxels": {"storage": "float", "glow": 100.0}}
    return draw(patch, block, normals)[4, 4, :3]


@pytest.mark.parametrize(
    ("normal", "facing", "upward"),
    [((0, 0, 1), 0.5, 1.0), ((1, 0, 0), 0.5 * 3**0.5, 0.5), ((-1, 0, 0), 0.0, 0.5), ((0, 0, 0), 0.25, 0.5)],
)
def test_normals_towards_and_away(draw: Draw, normal: tuple, facing: float, upward: float) -> None:
    sun, sky = arriving()
    exact = np.array([0.5, 0.25, 1.0]) / np.pi * (sun * facing + sky * upward)
    assert seen(draw, normal) == pytest.approx(exact, rel=1e-3)


def test_glow_adds(draw: Draw) -> None:
    more = seen(draw, (0, 0, 1), glow=0.5) - seen(draw, (0, 0, 1))
    assert more == pytest.approx(np.array([0.5, 0.25, 1.0]) * 50.0, rel=1e-3)


@pytest.mark.parametrize(
    ("right", "wrong"),
    [("max(dot(normal.xyz, sun_direction), 0.0)", "max(normal.z, 0.0)"), ("0.25 * (1.0 - agreed)", "(1.0 - agreed)")],
)
def test_a_wrong_cosine_is_found(draw: Draw, spoil: Callable, right: str, wrong: str) -> None:
    """The printed (0, 0, 1) . L among them: it ignores the voxel's own normal (erratum 002-10)."""
    before = seen(draw, (-1, 0, 0)), seen(draw, (0, 0, 0))
    with spoil(FILE, right, wrong):
        after = seen(draw, (1, 0, 0)), seen(draw, (0, 0, 0))
    sun, sky = arriving()
    exact = np.array([0.5, 0.25, 1.0]) / np.pi * (sun * np.cos(np.radians(ELEVATION)) + 0.5 * sky)
    assert max(abs(after[0] / exact - 1).max(), abs(after[1] / before[1] - 1).max()) > 0.1
