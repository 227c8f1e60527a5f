"""The probe gives back exactly what GLSL computed, for any number and kind of inputs."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.core.errors import ShaderError, UmbrageError
from renderer.gl.probe import probe
from renderer.gl.thread import GLThread

RNG = np.random.default_rng(3)


@pytest.mark.parametrize("count", [1, 2, 1023, 1024, 1025, 5000])
def test_every_input_meets_its_own_output(thread: GLThread, count: int) -> None:
    a, b = RNG.normal(size=count).astype(np.float32), RNG.normal(size=(count, 3)).astype(np.float32)
    read = thread.call(probe, [], "vec2(a, b.y)", {"a": a, "b": b}, 2)
    assert read.dtype == np.float32
    np.testing.assert_array_equal(read, np.stack([a, b[:, 1]], axis=1))


@pytest.mark.parametrize("outputs", [1, 2, 3, 4, 5, 8, 11, 32])
def test_any_number_of_components_comes_back(thread: GLThread, outputs: int) -> None:
    x = np.arange(7, dtype=np.float32)
    body = (f"for (int i = 0; i < {outputs}; i++) result[i] = x * 100.0 + float(i);" if outputs > 1
            else "result = x * 100.0;")
    read = thread.call(probe, [], body, {"x": x}, outputs)
    np.testing.assert_array_equal(read, x[:, None] * 100 + np.arange(outputs))


def lowbias32(x: np.ndarray) -> np.ndarray:
    """numpy twin of lib/hash.glsl."""
    x = x.astype(np.uint32)
    x = x ^ (x >> np.uint32(16))
    x = (x.astype(np.uint64) * 0x7FEB352D).astype(np.uint32)
    x = x ^ (x >> np.uint32(15))
    x = (x.astype(np.uint64) * 0x846CA68B).astype(np.uint32)
    return np.asarray(x ^ (x >> np.uint32(16)))


def test_integers_pass_bit_for_bit_and_the_hash_equals_its_twin(thread: GLThread) -> None:
    x = np.concatenate([np.array([0, 1, 2**31, 2**32 - 1]), RNG.integers(0, 2**32, 4000)]).astype(np.uint32)
    read = thread.call(probe, ["lib/hash.glsl"], "lowbias32(x)", {"x": x}, 1, dtype="u4")
    np.testing.assert_array_equal(read[:, 0], lowbias32(x))
    unit = thread.call(probe, ["lib/hash.glsl"], "hash_unit(x)", {"x": x}, 1)
    np.testing.assert_array_equal(unit[:, 0], (x >> 8) / np.float32(2**24))


def test_signed_integers_and_booleans_pass(thread: GLThread) -> None:
    i = np.array([-2**31, -1, 0, 2**31 - 1])
    read = thread.call(probe, [], "ivec2(i, yes)", {"i": i, "yes": i > -1}, 2, dtype="i4")
    np.testing.assert_array_equal(read, np.stack([i, i > -1], axis=1))


def test_extreme_floats_survive(thread: GLThread) -> None:
    x = np.array([0.0, -0.0, np.inf, -np.inf, 3.4e38, 1.2e-38, np.nan], np.float32)
    read = thread.call(probe, [], "x", {"x": x}, 1)[:, 0]
    np.testing.assert_array_equal(read, x)


def test_uniforms_are_declared_by_their_type_or_as_told(thread: GLThread) -> None:
    values = {"f": 2.0, "v": (1.0, 2.0, 3.0), "n": 3, "flag": True, "table": [1.0, 2.0, 4.0, 8.0, 16.0]}
    read = thread.call(probe, [], "x * f + v.z + float(n) + float(flag) + table[4]", {"x": np.array([10.0])}, 1,
                       uniforms=values, declarations="uniform float table[5];")
    assert read[0, 0] == 10 * 2 + 3 + 3 + 1 + 16
    with pytest.raises(UmbrageError, match="declare the probe's uniform table"):
        thread.call(probe, [], "x * table[4]", {"x": np.array([10.0])}, 1, uniforms={"table": values["table"]})


def test_defines_reach_the_body(thread: GLThread) -> None:
    read = thread.call(probe, [], "x * SCALE\n#if ZERO == 0\n + 1.0\n#endif\n", {"x": np.array([2.0])}, 1,
                       defines={"SCALE": 1.5, "ZERO": 0})
    assert read[0, 0] == 4.0


def test_an_error_in_the_body_is_told_and_nothing_leaks(thread: GLThread) -> None:
    with pytest.raises(ShaderError, match="wrong"):
        thread.call(probe, [], "wrong + x", {"x": np.array([2.0])}, 1)


@pytest.mark.parametrize(("inputs", "outputs", "words"), [
    ({}, 1, "at least one input"),
    ({"a": np.zeros(0)}, 1, "at least 1"),
    ({"a": np.zeros(2), "b": np.zeros(3)}, 1, "same length"),
    ({"a": np.zeros((2, 5))}, 1, "k up to 4"),
    ({"a": np.array(["x"])}, 1, "no GLSL type"),
    ({"a": np.zeros(2)}, 0, "1 to 32"),
    ({"a": np.zeros(2)}, 33, "1 to 32"),
])
def test_what_cannot_be_probed_is_said(thread: GLThread, inputs: dict[str, np.ndarray], outputs: int,
                                       words: str) -> None:
    with pytest.raises(UmbrageError, match=words):
        thread.call(probe, [], "a", inputs, outputs)
