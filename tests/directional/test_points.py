"""Points and codes in textures: where a point's words lie, in numpy and in GLSL."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.directional.points import WIDEST, code_texels
from renderer.gl.probe import probe
from renderer.gl.thread import GLThread

DECLARATIONS = """uniform usampler2D surfels; uniform usampler2D shadow_code;
uniform vec3 box_low; uniform vec3 box_high;"""
FILES = ["directional/frames.glsl", "directional/surfel.glsl"]


@pytest.mark.parametrize("count", [5, 65])
def test_a_points_words_are_found_where_they_were_put(thread: GLThread, count: int) -> None:
    """Of 129 directions, and of 2,049, of which fewer points fit into a row."""
    words = np.random.default_rng(1).integers(0, 1 << 32, (5000, count), dtype=np.uint32)
    texels, blocks = code_texels(words), -(-count // 4)
    assert texels.shape[1] <= WIDEST
    points = np.array([0, 1, 900, 963, 964, 2047, 2048, 4999], np.uint32)
    last = np.full(len(points), blocks - 1, np.int32)

    def read(gl) -> np.ndarray:
        code, none = gl.texture2d(texels, "nearest"), gl.texture2d(np.zeros((1, 1, 4), np.uint32))
        try:
            return probe(gl, FILES, "shadow_words(point, block)", {"point": points, "block": last}, 4, dtype="u4",
                         declarations=DECLARATIONS, textures={"shadow_code": code, "surfels": none},
                         defines={"SHADOW_BLOCKS": blocks})  # fmt: skip
        finally:
            code.release()
            none.release()

    found = thread.call(read)
    assert (found[:, 0] == words[points, 4 * (blocks - 1)]).all()
    assert (found[:, 1:] == 0).all(), "both counts leave one word for the last texel"
