"""Cases of a plane layer whose symptom is a number: the failing one fails, the surviving one survives."""

from __future__ import annotations

import numpy as np
import pytest

from renderer import slab_failures
from renderer.clouds.failures import FAILURES
from renderer.core.failure import ChartedFailure
from renderer.failing import charted

CASES = [
    case for case in FAILURES if isinstance(case, ChartedFailure) and case.measure.startswith(slab_failures.__name__)
]


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_the_failing_one_fails_and_the_surviving_one_survives(
    case: ChartedFailure, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(slab_failures, "PHOTONS", 50_000)
    found = charted(case)
    assert found.surviving <= case.threshold < found.failing
    assert found.failing == pytest.approx(case.measured[0], rel=0.1)
    assert {curve.part for curve in found.curves} >= {"failing", "surviving"}
    assert all(np.isfinite(curve.y).all() and curve.x.shape == curve.y.shape for curve in found.curves)


def test_every_measure_is_a_case() -> None:
    assert {case.measure.partition(":")[2] for case in CASES} == {
        "plane_at_the_horizon",
        "plain_float32",
        "double_scattering",
        "low_sun",
    }
