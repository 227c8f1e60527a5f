"""Learnt patterns: few of them are kept whole, many are misjudged least, and the same in GLSL."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.directional.codes.code import judged
from renderer.directional.codes.codebook import learn, learnt, nearest_of
from renderer.directional.codes.harmonics import Harmonics
from renderer.directional.hemisphere import hemisphere_of
from renderer.directional.self_shadow.codebook import Codebook
from tests.directional.self_shadow.conftest import ARC, caps, dem_x4, errors, horizons, leaves, towards, twin

FILE = "directional/self_shadow/codebook.glsl"
LAYOUT = hemisphere_of(129)


def test_what_repeats_is_kept_whole() -> None:
    assert errors(learn(LAYOUT, 9, dem_x4()), dem_x4()) == (0.0, 0.0)
    masks = horizons(LAYOUT, 2000)
    assert errors(learn(LAYOUT, 9, masks), masks) == (0.0, 0.0)


def test_the_zenith_is_kept() -> None:
    masks = caps(LAYOUT, 400)
    code = learn(LAYOUT, 9, masks)
    assert (judged(code, code.encode(masks))[:, -1] == masks[:, -1]).mean() > 0.99


def test_nine_bytes_misjudge_less_than_harmonics() -> None:
    """On masks that it never saw, too."""
    taught, unseen = leaves(LAYOUT, 1500), leaves(LAYOUT, 400, seed=9)
    code = learn(LAYOUT, 9, taught)
    own, other, waves = errors(code, taught)[1], errors(code, unseen)[1], errors(Harmonics(LAYOUT), unseen)[1]
    assert own < 0.10
    assert other < 0.125
    assert waves > 0.16
    assert own < errors(learn(LAYOUT, 5, taught), taught)[1] < waves


def test_a_book_is_at_rest() -> None:
    """No pattern is nearer to another than to its own, and majorities of those that are its own change nothing much."""
    patterns = leaves(LAYOUT, 1500).reshape(-1, 129)[:, :16]
    book = learnt(patterns, 64)
    number, apart = nearest_of(patterns, book)
    brute = (patterns[:, None] != book[None]).sum(axis=2)
    np.testing.assert_array_equal(apart, brute.min(axis=1))
    np.testing.assert_array_equal(brute[np.arange(len(brute)), number], apart)
    commonest = np.unique(patterns, axis=0, return_counts=True)
    first = commonest[0][np.argsort(-commonest[1])[:64]]
    assert apart.sum() < nearest_of(patterns, first)[1].sum()


@pytest.mark.parametrize("blend", [True, False])
@pytest.mark.parametrize(("count", "size"), [(129, 5), (129, 9), (513, 9)])
def test_glsl_reads_as_numpy(see: Callable, count: int, size: int, blend: bool) -> None:
    layout, given = hemisphere_of(count), towards(300)
    masks = caps(layout, 300)
    code = learn(layout, size, masks, blend)
    words = code.encode(masks)
    seen = see(Codebook(size=size, blend=blend), layout, words, given, code.tables())
    # By Mesa's arc sine a row may be another where a direction falls on its edge.
    assert np.sort(np.abs(seen - twin(code, words, given)))[-1 if blend else -4] < ARC


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("sector * SELF_SHADOW_SIZE,", "sector * 8,"),
        ("ivec2(int(number), sector)", "ivec2(int(number), 0)"),
    ],
)
def test_a_wrong_pattern_is_found(see: Callable, spoil: Callable, right: str, wrong: str) -> None:
    given, masks = towards(300), caps(LAYOUT, 300)
    code = learn(LAYOUT, 9, masks)
    words = code.encode(masks)
    with spoil(FILE, right, wrong):
        assert np.abs(see(Codebook(), LAYOUT, words, given, code.tables()) - twin(code, words, given)).max() > 0.1
