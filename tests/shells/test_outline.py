"""What the page draws over the picture: the cells as they stand, and where they are in conflict."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from renderer.core.errors import InputError
from renderer.core.params import validate
from renderer.session import Session
from renderer.shells import outline as outlines
from renderer.shells.bakes import shell_bake, surface_bake
from renderer.shells.outline import CONFLICT, SHORTER, THERE_BEFORE, outline
from renderer.shells.state import ShellsState

BASE: dict[str, Any] = {"scene": "shells", "surface": {"kind": "sphere", "divisions": 4}}


def drawn(**patch: Any) -> tuple[ShellsState, Any]:
    state = validate(ShellsState, {**BASE, **patch})
    surface = surface_bake(state)
    arrays = {"surface": surface.function(surface.arguments, {}, lambda *_: None)}
    shell = shell_bake(state)
    arrays["shell"] = shell.function(shell.arguments, arrays, lambda *_: None)
    return state, outline(state, arrays)


TEAPOT = {"surface": {"kind": "teapot"}}


def test_lines_join_the_shells_vertices_and_nothing_is_marked_where_nothing_is_amiss() -> None:
    _, found = drawn(extrusion={"thickness": 0.1})
    positions, ends = found.arrays["positions"], found.arrays["ends"]
    count = len(found.arrays["rest"])
    assert len(positions) == 2 * count
    upright = found.arrays["marks"] == 2
    assert upright.sum() == count
    length = np.linalg.norm(positions[ends[upright, 1]] - positions[ends[upright, 0]], axis=1)
    np.testing.assert_allclose(length, 0.1, rtol=1e-5)
    assert found.arrays["marks"].max() <= 3
    assert found.words == ()
    assert found.facts["tetrahedra"] == 3 * len(found.arrays["faces"])


def test_conflicts_are_marked_and_clamping_marks_what_it_shortened() -> None:
    """On a teapot's thick shell; what handle and body have of their own stays."""
    _, loose = drawn(**TEAPOT, extrusion={"thickness": 0.3, "clamp": False})
    _, clamped = drawn(**TEAPOT, extrusion={"thickness": 0.3})
    bad, left = (int((found.arrays["marks"] & CONFLICT > 0).sum()) for found in (loose, clamped))
    assert bad > 5 * left > 0
    assert not (loose.arrays["marks"] & SHORTER).any()
    shorter = clamped.arrays["marks"] & SHORTER > 0
    assert shorter.sum() == clamped.facts["clamped_vertices"] > 0
    # What was in conflict with the wanted offsets is told of both alike.
    before = clamped.arrays["marks"] & THERE_BEFORE > 0
    np.testing.assert_array_equal(before, loose.arrays["marks"] & CONFLICT > 0)
    assert any("overlap" in words for words in clamped.words)


def test_lines_follow_a_motion_and_paint_stays_on_the_surface_at_rest() -> None:
    moving = {"motion": {"kind": "bend", "angle": 90}, "surface": {"kind": "tube"}}
    _, start = drawn(**moving)
    _, later = drawn(**moving, time=1.5)
    np.testing.assert_array_equal(start.arrays["rest"], later.arrays["rest"])
    assert np.abs(later.arrays["positions"] - start.arrays["positions"]).max() > 0.3


def test_of_too_many_lines_those_in_conflict_are_given_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(outlines, "MOST_LINES", 100)
    _, found = drawn(**TEAPOT, extrusion={"thickness": 0.3, "clamp": False})
    assert len(found.arrays["ends"]) == len(found.arrays["marks"]) == 100
    assert (found.arrays["marks"] >= CONFLICT).all()
    assert "too many" in found.words[-1]


def test_a_scene_without_cells_says_so() -> None:
    with Session() as session, pytest.raises(InputError, match="no lines") as refused:
        session.outline(session.state("forest"))
    assert refused.value.field == "scene"
    assert refused.value.allowed == "shells"
