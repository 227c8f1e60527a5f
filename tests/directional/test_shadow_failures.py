"""What shadow hemispheres miss is above its threshold, and what survives below."""

from __future__ import annotations

import pytest

from renderer.core.failure import ChartedFailure
from renderer.directional.shadow_failures import SHADOW_FAILURES
from renderer.failing import charted


@pytest.mark.parametrize("case", SHADOW_FAILURES, ids=lambda case: case.name)
def test_what_fails_fails_and_what_survives_survives(case: ChartedFailure) -> None:
    found = charted(case)
    assert found.surviving <= case.threshold < found.failing
    assert found.failing == pytest.approx(case.measured[0], abs=0.005)
    assert found.surviving == pytest.approx(case.measured[1], abs=0.005)
    assert {curve.part for curve in found.curves} == {"failing", "surviving"}
