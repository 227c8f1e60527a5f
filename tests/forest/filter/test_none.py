"""No filtering: the finest level at every distance."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from renderer.forest.filter.none import NoFilter
from tests.forest.truth import MARCH, Judge


def test_every_width_reads_the_finest_level(ask: Callable[..., np.ndarray]) -> None:
    found = ask(["forest/filter/none.glsl"], "filter_level(width)", {"width": np.array([0.0, 0.6, 5.0, 1e4])},
                techniques={"filter": NoFilter()})
    assert (found == 0).all()


def test_distance_to_the_reference(judge: Judge) -> None:
    judge.holds("filter", "none", MARCH)


def test_filtering_is_told_from_none(judge: Judge) -> None:
    assert judge.distance("filter", "mipmap") > 1.1 * MARCH


def test_picture(judge: Judge) -> None:
    judge.looks("filter", "none")
