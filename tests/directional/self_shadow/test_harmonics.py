"""Principal harmonics: single ones in closed form, what nine bytes misjudge, and the same in GLSL."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.directional.codes.code import SIZES, decode, get, judged
from renderer.directional.codes.harmonics import HARMONICS, MOST, ringing
from renderer.directional.codes.harmonics import Harmonics as Code
from renderer.directional.hemisphere import hemisphere_of
from renderer.directional.self_shadow.harmonics import Harmonics
from tests.directional.self_shadow.conftest import ARC, caps, dem_x4, errors, towards, twin

FILE = "directional/self_shadow/harmonics.glsl"
LAYOUT = hemisphere_of(129)


def test_numbers_stand_for_all_harmonics_but_the_checkerboard() -> None:
    found = {(u % 16, v % 8) for u, v in HARMONICS}
    mirrored = {(-u % 16, -v % 8) for u, v in HARMONICS}
    every = {(u, v) for u in range(16) for v in range(8)}
    assert len(found) == 64
    assert every - found - mirrored == {(0, 0), (8, 4)}


def test_half_a_sky_is_its_first_harmonic_in_closed_form() -> None:
    turn = np.tile(np.arange(16) < 8, 8)
    words = Code(LAYOUT).encode(np.append(turn, True)[None])
    number, level = get(words, 0, 6)[0], get(words, 6, 5)[0]
    assert HARMONICS[number] == (1, 0)
    assert level == 31
    mask = np.exp(2j * np.pi * np.arange(8) / 16).sum()
    assert abs(mask) / 8 == pytest.approx(MOST)
    assert get(words, 64, 8)[0] == 128  # the mean, half


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("count", [129, 513])
def test_glsl_reads_as_numpy(see: Callable, size: int, count: int) -> None:
    layout = hemisphere_of(count)
    code, given = Code(layout, size), towards(300)
    words = code.encode(caps(layout, 300))
    assert words.shape[1] == -(-size // 4)
    error = np.abs(see(Harmonics(size=size), layout, words, given) - twin(code, words, given))
    assert error.max() < ARC


def test_more_harmonics_misjudge_less() -> None:
    masks = caps(LAYOUT, 1000)
    wrong = [float((judged(Code(LAYOUT, size), Code(LAYOUT, size).encode(masks)) != masks).mean()) for size in SIZES]
    assert wrong == sorted(wrong, reverse=True)
    assert wrong[1] < 0.11  # four harmonics of skies with four round obstacles
    assert wrong[3] < 0.03


def test_four_harmonics_err_as_the_references_measured() -> None:
    """g_shadow9.json, `L2 adaptive 4 DFT harmonics 6+5+5 bit`: 0.2323 and 6.28 %; eight unquantised 0.1751 and 2.31 %.

    Its quantiser is another: what differs is how amplitudes are stepped.
    """
    rms, wrong = errors(Code(LAYOUT), dem_x4())
    assert rms == pytest.approx(0.2323, abs=0.002)
    assert wrong == pytest.approx(0.0628, abs=0.0025)
    rms, wrong = errors(Code(LAYOUT, 17), dem_x4())
    assert rms == pytest.approx(0.1751, abs=0.003)
    assert wrong == pytest.approx(0.0231, abs=0.004)


def test_few_harmonics_ring() -> None:
    masks = caps(LAYOUT, 300)
    share, worst = ringing(decode(Code(LAYOUT), Code(LAYOUT).encode(masks)))
    assert share > 0.03
    assert worst > 0.2
    assert ringing(masks.astype(float)) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("right", "wrong"),
    [("float((field >> 11) & 31) / 32.0", "float((field >> 11) & 31) / 31.0"), ("periods.y - 8", "periods.y - 7")],
)
def test_a_wrong_harmonic_is_found(see: Callable, spoil: Callable, right: str, wrong: str) -> None:
    given = towards(300)
    words = Code(LAYOUT).encode(caps(LAYOUT, 300))
    with spoil(FILE, right, wrong):
        assert np.abs(see(Harmonics(), LAYOUT, words, given) - twin(Code(LAYOUT), words, given)).max() > 0.01
