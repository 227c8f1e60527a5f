"""All harmonics: the bits exactly, the transform's own sum between them, and the same in GLSL."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.directional.codes.code import decode, judged
from renderer.directional.codes.exact_harmonics import ExactHarmonics as Code
from renderer.directional.codes.exact_harmonics import packet
from renderer.directional.codes.harmonics import ringing
from renderer.directional.hemisphere import hemisphere_of
from renderer.directional.self_shadow.exact_harmonics import ExactHarmonics
from tests.directional.self_shadow.conftest import ARC, caps, leaves, towards, twin

FILE = "directional/self_shadow/exact_harmonics.glsl"


@pytest.mark.parametrize("count", [33, 129, 513])
def test_all_harmonics_reproduce_the_bits_exactly(count: int) -> None:
    layout = hemisphere_of(count)
    code = Code(layout)
    for masks in (caps(layout, 100), leaves(layout, 100)):
        words = code.encode(masks)
        np.testing.assert_allclose(decode(code, words), masks, atol=1e-12)
        np.testing.assert_array_equal(judged(code, words), masks)


def test_between_directions_it_is_the_sum_of_the_transform() -> None:
    """By numpy's transform: every coefficient in full precision, its wave taken at any place."""
    layout = hemisphere_of(129)
    masks = caps(layout, 20)
    rng = np.random.default_rng(6)
    places = np.stack([rng.uniform(0.5, 7.5, 50), rng.uniform(0, 16, 50)], axis=-1)
    found = np.fft.fft2(masks[:, :-1].reshape(-1, 8, 16)) / 128
    # The finest waves stand for both signs alike.
    v, u = np.fft.fftfreq(8, 1 / 8), np.fft.fftfreq(16, 1 / 16)
    up = np.exp(2j * np.pi * np.outer(places[:, 0] - 0.5, v) / 8)
    up[:, 4] = np.cos(np.pi * (places[:, 0] - 0.5))
    around = np.exp(2j * np.pi * np.outer(places[:, 1], u) / 16)
    around[:, 8] = np.cos(np.pi * places[:, 1])
    wanted = np.einsum("mvu,kv,ku->mk", found, up, around)
    np.testing.assert_allclose(wanted.imag, 0, atol=1e-12)
    np.testing.assert_allclose(Code(layout).evaluate(Code(layout).encode(masks), places), wanted.real, atol=1e-12)


def test_packets_add_up_to_one() -> None:
    x = np.linspace(0, 16, 99)
    np.testing.assert_allclose(packet(x[:, None] - np.arange(16), 16).sum(axis=1), 1, atol=1e-12)


def test_it_rings_between_directions() -> None:
    layout = hemisphere_of(129)
    code = Code(layout)
    rng = np.random.default_rng(6)
    places = np.stack([rng.uniform(0.5, 7.5, 50), rng.uniform(0, 16, 50)], axis=-1)
    assert ringing(code.evaluate(code.encode(caps(layout, 100)), places))[1] > 0.1


@pytest.mark.parametrize("count", [129, 513])
def test_glsl_reads_as_numpy(see: Callable, count: int) -> None:
    layout = hemisphere_of(count)
    code, given = Code(layout), towards(200)
    words = code.encode(caps(layout, 200))
    assert np.abs(see(ExactHarmonics(), layout, words, given) - twin(code, words, given)).max() < ARC


def test_a_wrong_packet_is_found(see: Callable, spoil: Callable) -> None:
    layout = hemisphere_of(129)
    code, given = Code(layout), towards(200)
    words = code.encode(caps(layout, 200))
    with spoil(FILE, "* cos(angle) /", "/"):
        assert np.abs(see(ExactHarmonics(), layout, words, given) - twin(code, words, given)).max() > ARC
