"""The shells' cases of failure that cost little to measure again: the failing one fails, the surviving one survives."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from renderer import failing
from renderer.core.failure import ChartedFailure, Failure
from renderer.session import Session
from renderer.shells import shell_failures
from renderer.shells.failures import FAILURES
from renderer.shells.shell_failures import share_twice

CORNER = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float64)
NAMED = {case.name: case for case in FAILURES}
CHEAP = ("opacity_by_step_count", "camera_inside")


@pytest.fixture(scope="module")
def session() -> Iterator[Session]:
    with Session() as made:
        yield made


@pytest.mark.parametrize("name", CHEAP)
def test_the_failing_one_fails_and_the_surviving_one_survives(
    session: Session, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In references of 16 pixels, and without the pictures that are shown."""
    monkeypatch.setattr(failing, "_picture", lambda *given: b"")
    case = NAMED[name]
    assert isinstance(case, Failure)
    little = replace(case, width=16, steps=min(case.steps, 1))
    found = failing._judged(session, "shells", little, None)
    assert found.surviving <= case.threshold < found.failing


def test_a_thick_shell_meets_itself_in_a_hollow(monkeypatch: pytest.MonkeyPatch) -> None:
    case = NAMED["concave_surface"]
    assert isinstance(case, ChartedFailure)
    monkeypatch.setattr(shell_failures, "THICKNESSES", (0.02, 0.3))
    monkeypatch.setattr(shell_failures, "POINTS", 600)
    found = failing.charted(case)
    assert found.surviving == 0 < case.threshold < found.failing
    assert found.failing == pytest.approx(case.measured[0], rel=0.35)
    assert found.curves[0].y[0] < 0.01, "a thin shell does not"


def test_volume_that_lies_in_two_cells_is_counted() -> None:
    far = CORNER + 5
    assert share_twice(np.stack([CORNER, far])) == 0
    assert share_twice(np.stack([CORNER, CORNER])) == 1
    turned = CORNER[[0, 2, 1, 3]]
    assert share_twice(np.stack([CORNER, turned])) == 1, "inside out or not"
    inner = 0.25 + 0.5 * (CORNER - 0.25)
    assert share_twice(np.stack([CORNER, inner])) == pytest.approx(2 * 0.125 / 1.125, abs=0.03)
    shared = np.stack([CORNER, CORNER * [1, 1, -1]])
    assert share_twice(shared) == 0, "cells that share a face do not overlap"
