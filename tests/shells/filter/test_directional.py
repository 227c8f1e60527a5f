"""Coarser voxels that hide by the direction of the ray: closed forms of columns and plates, and fine rays."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from renderer.shells.texture.directional import directional_pyramid
from renderer.shells.texture.extinction import Extinct
from tests.shells.filter.boards import board, contrast

Draw = Callable[..., np.ndarray]
DIRECTIONAL = {"kind": "directional", "bias": 0.0}
LAYERS, THICK = 8, 0.5
LENGTH = THICK / LAYERS


def columns() -> np.ndarray:
    """Upright opaque columns over a sixteenth of the ground."""
    block = np.zeros((LAYERS, 64, 64, 4), np.float32)
    block[..., :3] = 1.0
    block[:, ::4, ::4, 3] = 0.9999
    return block


def plates() -> np.ndarray:
    """Two level plates over all of the ground that let half of the light through, each."""
    block = np.zeros((LAYERS, 64, 64, 4), np.float32)
    block[..., :3] = 1.0
    block[(1, 5), ..., 3] = 0.5
    return block


def opacity(
    draw: Draw, kind: dict[str, Any], block: np.ndarray, turn: float, size: int = 6, width: float = 0.6, **more: Any
) -> float:
    """Mean opacity of the middle of the shell, looked at from `turn` degrees off the zenith."""
    across, down = math.sin(math.radians(turn)), math.cos(math.radians(turn))
    camera = {"kind": "orthographic", "centre": [0, 0, 0.25], "direction": [0, across, -down], "up": [0, down, across],
              "width": width}  # fmt: skip
    found = draw({"filter": kind, "camera": camera, **more}, block, reference_length=LENGTH, size=size)
    return float(found[..., 3].mean())


@pytest.mark.parametrize("storage", ["float", "half", "bytes"])
def test_columns_are_thin_from_above(draw: Draw, storage: str) -> None:
    straight = {"voxels": {"interpolation": "straight" if storage == "bytes" else "extinction", "storage": storage}}
    assert opacity(draw, DIRECTIONAL, columns(), 0, **straight) == pytest.approx(1 / 16, rel=0.1)


@pytest.mark.parametrize("turn", [0.0, 30.0, 50.0])
def test_the_picture_is_that_of_the_ellipsoid(draw: Draw, turn: float) -> None:
    """Every voxel of the level that is read is alike, so a ray's depth is its extinction times the way."""
    matter = columns()
    matter[..., 3] = -np.log1p(-np.minimum(matter[..., 3], 1 - 2.0**-12))
    voxel = (LAYERS * 2.0 / 64 / THICK, LAYERS * 2.0 / 64 / THICK, 1.0)
    towards = (0.0, math.sin(math.radians(turn)), -math.cos(math.radians(turn)))
    level = directional_pyramid(Extinct(matter, np.zeros_like(matter)), voxel)[2].towards(np.array(towards))
    way = LAYERS / math.cos(math.radians(turn))
    wanted = -math.expm1(-float(level[..., 3].mean()) * way)
    found = opacity(draw, {**DIRECTIONAL, "bias": math.log2(4 / (32 * 0.6 / 6))}, columns(), turn)
    assert found == pytest.approx(wanted, rel=0.03)


def test_plates_keep_what_they_let_through_askew(draw: Draw) -> None:
    """Level plates let a quarter through from above, and exp(-2 ln 2 / cos) of it askew, at every level."""
    for turn in (0.0, 45.0):
        wanted = -math.expm1(-2 * math.log(2) / math.cos(math.radians(turn)))
        assert opacity(draw, {**DIRECTIONAL, "bias": -1.0}, plates(), turn) == pytest.approx(wanted, rel=0.03)


@pytest.mark.parametrize(("turn", "thick"), [(90, 2.0), (70, 1.1)])
def test_a_sheet_seen_from_its_edge_stays_thin(draw: Draw, turn: float, thick: float) -> None:
    """An opaque sheet in one of eight layers of a shell that is a few voxels wide: opacities put together along w alone
    make it as thick as a coarse voxel. Fine rays are the truth."""
    block = np.zeros((LAYERS, 4, 4, 4), np.float32)
    block[..., :3] = 1.0
    block[3, ..., 3] = 0.9999
    whole = {"voxels": {"interpolation": "straight", "storage": "float"}, "width": 2.4}
    fine = opacity(draw, {"kind": "none"}, block, turn, 192, **whole)
    assert opacity(draw, {**DIRECTIONAL, "bias": 3.3}, block, turn, 24, **whole) == pytest.approx(fine, rel=0.15)
    assert opacity(draw, {"kind": "mipmap", "bias": 3.3}, block, turn, 24, **whole) > thick * fine


def test_a_far_board_is_grey_and_a_near_one_is_not(draw: Draw) -> None:
    assert contrast(draw, DIRECTIONAL, board()) < 0.05
    assert contrast(draw, {**DIRECTIONAL, "bias": -4.0}, board()) > 0.1


def test_near_views_read_the_finest_alone(draw: Draw, spoil: Callable) -> None:
    """Where no pixel is wider than a voxel the program knows neither levels nor directions."""
    near = {"kind": "orthographic", "centre": [0, 0, 0], "direction": [0, 0, -1], "up": [0, 1, 0], "width": 0.1}
    with spoil("shells/filter/directional.glsl", "sqrt(dot(way_shares, along * along))", "0.0"):
        near_by = draw({"filter": DIRECTIONAL, "camera": near}, board(), size=16)
        assert float(near_by[..., 3].min()) > 0.9
        assert opacity(draw, DIRECTIONAL, columns(), 30) == 0, "and farther ones do"


@pytest.mark.parametrize(("right", "wrong"), [
    ("dot(way_shares, along * along)", "dot(vec3(1.0), along * along)"),
    ("stored.y", "0.0 * stored.y"),
    ("dot(way_shares, along * along)", "dot(way_shares.zyx, along * along)"),
])
def test_a_wrong_direction_is_found(draw: Draw, spoil: Callable, right: str, wrong: str) -> None:
    with spoil("shells/filter/directional.glsl", right, wrong), pytest.raises(AssertionError):
        test_the_picture_is_that_of_the_ellipsoid(draw, 50.0)
