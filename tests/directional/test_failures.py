"""The charted cases of the catalogue still fail where they failed, and survive where something did."""

from __future__ import annotations

import pytest

from renderer.core.failure import ChartedFailure
from renderer.directional.failures import FAILURES
from renderer.failing import charted

CHARTED = [case for case in FAILURES if isinstance(case, ChartedFailure)]


@pytest.mark.parametrize("case", CHARTED, ids=lambda case: case.name)
def test_a_charted_case_holds(case: ChartedFailure) -> None:
    now = charted(case)
    assert now.surviving <= case.threshold < now.failing
    assert (now.failing, now.surviving) == pytest.approx(case.measured, rel=0.05, abs=1e-3)
    for curve in now.curves:
        assert len(curve.x) == len(curve.y)
        assert curve.y.min() >= 0
        assert curve.y.max() <= 1


def test_every_failure_of_the_design_is_there() -> None:
    names = {case.name for case in FAILURES}
    assert {"popping", "ghosting", "thin_parts", "inside_the_box", "grazing_light", "ringing", "open_mesh"} <= names
