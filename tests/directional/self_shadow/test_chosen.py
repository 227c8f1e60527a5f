"""For each point its best code: rings for land, books for leaves, never worse than the ring, and the same in GLSL."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.directional.codes.chosen import CHOICE, OFFSETS, WIDTHS, learn_sets
from renderer.directional.codes.code import get, judged
from renderer.directional.codes.codebook import learn
from renderer.directional.codes.horizon_ring import HorizonRing
from renderer.directional.hemisphere import hemisphere_of
from renderer.directional.self_shadow.chosen import Chosen
from tests.directional.self_shadow.conftest import ARC, caps, dem_x4, errors, horizons, leaves, towards, twin

FILE = "directional/self_shadow/chosen.glsl"
LAYOUT = hemisphere_of(129)


def test_fields_fill_nine_bytes() -> None:
    assert OFFSETS[-1] + WIDTHS[-1] == CHOICE
    assert CHOICE + 2 == 72


def test_land_takes_the_ring() -> None:
    code = learn_sets(LAYOUT, dem_x4())
    words = code.encode(dem_x4())
    assert (get(words, CHOICE, 2) == 0).all()
    np.testing.assert_array_equal(judged(code, words), dem_x4())


def test_a_mixture_is_misjudged_less_than_by_any_single_code() -> None:
    masks = np.concatenate([leaves(LAYOUT, 1200), horizons(LAYOUT, 300), caps(LAYOUT, 300)])
    code = learn_sets(LAYOUT, masks)
    words = code.encode(masks)
    assert set(get(words, CHOICE, 2)) == {0, 1, 2, 3}
    own = judged(code, words) != masks
    ring = judged(HorizonRing(LAYOUT), HorizonRing(LAYOUT).encode(masks)) != masks
    assert (own.sum(axis=1) <= ring.sum(axis=1)).all()
    assert own.mean() < errors(learn(LAYOUT, 9, masks), masks)[1]


@pytest.mark.parametrize("blend", [True, False])
def test_glsl_reads_as_numpy(see: Callable, blend: bool) -> None:
    given = towards(300)
    masks = np.concatenate([leaves(LAYOUT, 100), horizons(LAYOUT, 100), caps(LAYOUT, 100)])
    code = learn_sets(LAYOUT, masks, blend)
    words = code.encode(masks)
    seen = see(Chosen(blend=blend), LAYOUT, words, given, code.tables())
    # By Mesa's arc sine a row may be another where a direction falls on its edge.
    assert np.sort(np.abs(seen - twin(code, words, given)))[-1 if blend else -4] < ARC


@pytest.mark.parametrize(
    ("right", "wrong"),
    [("8 * max(choice - 1, 0)", "8 * choice"), ("- max(sector - 6, 0)", "- 0")],
)
def test_a_wrong_choice_is_found(see: Callable, spoil: Callable, right: str, wrong: str) -> None:
    given, masks = towards(300), leaves(LAYOUT, 300)
    code = learn_sets(LAYOUT, masks)
    words = code.encode(masks)
    with spoil(FILE, right, wrong):
        assert np.abs(see(Chosen(), LAYOUT, words, given, code.tables()) - twin(code, words, given)).max() > 0.1
