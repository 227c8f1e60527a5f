"""Textures from arrays hold what they were given, at every level, and refuse what they cannot hold."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.core.errors import LimitError, UmbrageError
from renderer.gl.context import GL
from renderer.gl.probe import probe
from renderer.gl.textures import sampler_type
from renderer.gl.thread import GLThread

RNG = np.random.default_rng(7)


@pytest.mark.parametrize(("dtype", "scale"), [("uint8", 255), ("uint16", 65535), ("float16", 1), ("float32", 1)])
@pytest.mark.parametrize("components", [1, 2, 3, 4])
def test_a_2d_texture_reads_as_its_array(thread: GLThread, dtype: str, scale: float, components: int) -> None:
    """Odd widths and odd bytes a row, so that a wrong row alignment would shear it."""
    data = (RNG.random((5, 7, components)) * scale).astype(dtype)
    rows, columns = np.indices((5, 7)).reshape(2, -1)

    def job(gl: GL) -> np.ndarray:
        texture = gl.texture2d(data, filter="nearest")
        read = probe(gl, [], "texelFetch(image, place, 0)", {"place": np.stack([columns, rows], axis=1)}, 4,
                     textures={"image": texture})
        texture.release()
        return read
    read = thread.call(job)[:, :components].reshape(data.shape)
    np.testing.assert_allclose(read, data / np.float32(scale), rtol=1e-6)


def test_a_plain_matrix_is_a_texture_of_one_component(thread: GLThread) -> None:
    def job(gl: GL) -> tuple[int, ...]:
        textures = gl.texture2d(np.zeros((2, 3), np.uint8)), gl.texture3d(np.zeros((2, 3, 4), np.uint8))
        for texture in textures:
            texture.release()
        return *textures[0].size, textures[0].components, *textures[1].size, textures[1].components
    assert thread.call(job) == (3, 2, 1, 4, 3, 2, 1)


@pytest.mark.parametrize("dimensions", [2, 3])
@pytest.mark.parametrize("dtype", ["uint8", "float32"])
def test_given_mip_levels_are_used_as_given(thread: GLThread, dimensions: int, dtype: str) -> None:
    """Levels of unlike values, so that levels averaged by the driver would show."""
    shape = (6, 10, 13)[-dimensions:]
    levels = [np.full((*(max(1, side >> n) for side in shape), 3), 20 + 40 * n, dtype) for n in range(4)]
    scale = 255.0 if dtype == "uint8" else 1.0

    def job(gl: GL) -> np.ndarray:
        texture = (gl.texture2d if dimensions == 2 else gl.texture3d)(levels[0], mips=levels[1:])
        place = ", ".join(["0.4"] * dimensions)
        read = probe(gl, [], f"textureLod(image, vec{dimensions}({place}), level).rgb",
                     {"level": np.array([0, 1, 2, 3, 1.5, 9])}, 3, textures={"image": texture})
        texture.release()
        return read
    expected = np.array([20, 60, 100, 140, 80, 140]) / scale  # between levels linear, beyond the last the last
    np.testing.assert_allclose(thread.call(job), np.repeat(expected[:, None], 3, axis=1), rtol=2e-3)


def test_wrapping_and_filtering_follow_each_axis(thread: GLThread) -> None:
    """Repeat across u and v, clamp along w: the forest's atlas; texel centres at half integers."""
    data = RNG.random((4, 5, 6, 4)).astype(np.float32)
    place = RNG.uniform(-2, 3, (400, 3))

    def job(gl: GL) -> np.ndarray:
        texture = gl.texture3d(data, wrap=("repeat", "repeat", "clamp"))
        read = probe(gl, [], "texture(image, p)", {"p": place}, 4, textures={"image": texture})
        texture.release()
        return read
    x = place.astype(np.float32).astype(np.float64) * [6, 5, 4] - 0.5
    low = np.floor(x).astype(int)
    weight = x - low
    expected = np.zeros((400, 4))
    for corner in np.ndindex(2, 2, 2):
        c, r, k = (low + corner).T
        part = np.prod(np.where(corner, weight, 1 - weight), axis=1)
        expected += part[:, None] * data[np.clip(k, 0, 3), r % 5, c % 6]
    # The rasteriser's filter weights are of at least 8 bits: 3 axes x half a step of 1/256 on values up to 1.
    np.testing.assert_allclose(thread.call(job), expected, atol=3 * 0.5 / 256)


def test_an_array_texture_keeps_its_layers_apart(thread: GLThread) -> None:
    data = RNG.integers(0, 256, (3, 4, 5, 2), dtype=np.uint8)
    layer, row, column = np.indices((3, 4, 5)).reshape(3, -1)

    def job(gl: GL) -> np.ndarray:
        texture = gl.texture_array(data)
        assert sampler_type(texture) == "sampler2DArray"
        read = probe(gl, [], "texelFetch(image, place, 0).rg", {"place": np.stack([column, row, layer], axis=1)}, 2,
                     textures={"image": texture})
        texture.release()
        return read
    np.testing.assert_allclose(thread.call(job).reshape(data.shape) * 255, data, rtol=1e-6)


def test_levels_of_an_array_texture_keep_its_layers(thread: GLThread) -> None:
    data = RNG.integers(0, 256, (3, 4, 8, 4), dtype=np.uint8)
    half, quarter = (RNG.integers(0, 256, (3, 4 // n, 8 // n, 4), dtype=np.uint8) for n in (2, 4))
    layer, row, column = np.indices(half.shape[:3]).reshape(3, -1)

    def job(gl: GL) -> np.ndarray:
        texture = gl.texture_array(data, "nearest", "repeat", [half, quarter])
        read = probe(gl, [], "texelFetch(image, place, 1)", {"place": np.stack([column, row, layer], axis=1)}, 4,
                     textures={"image": texture})
        texture.release()
        return read
    np.testing.assert_allclose(thread.call(job).reshape(half.shape) * 255, half, rtol=1e-6)


def test_an_array_texture_refuses_levels_of_fewer_layers(thread: GLThread) -> None:
    data, wrong = np.zeros((4, 4, 4), np.uint8), np.zeros((2, 2, 2), np.uint8)
    with pytest.raises(UmbrageError, match="mip level 1"):
        thread.call(lambda gl: gl.texture_array(data, mips=[wrong]))


@pytest.mark.parametrize(("dtype", "sampler"), [("int32", "isampler2D"), ("uint32", "usampler2D")])
def test_integers_stay_integers(thread: GLThread, dtype: str, sampler: str) -> None:
    data = np.array([[2**31 - 1, 5, 16_777_217]], dtype)

    def job(gl: GL) -> np.ndarray:
        texture = gl.texture2d(data)
        assert sampler_type(texture) == sampler
        kind = "i4" if dtype == "int32" else "u4"
        read = probe(gl, [], "texelFetch(image, ivec2(x, 0), 0).r", {"x": np.arange(3)}, 1, dtype=kind,
                     textures={"image": texture})
        texture.release()
        return read
    assert thread.call(job)[:, 0].tolist() == data[0].tolist()


@pytest.mark.parametrize(("data", "words"), [
    (np.zeros((2, 2), np.float64), "float64"),
    (np.zeros((2, 2, 5), np.uint8), "shape"),
    (np.zeros((2, 2, 2, 2), np.uint8), "shape"),
    (np.zeros((0, 2), np.uint8), "shape"),
    (np.zeros(4, np.uint8), "shape"),
])
def test_what_no_texture_holds_is_refused(thread: GLThread, data: np.ndarray, words: str) -> None:
    with pytest.raises(UmbrageError, match=words):
        thread.call(lambda gl: gl.texture2d(data))


@pytest.mark.parametrize("mips", [[np.zeros((3, 4, 1), np.uint8)], [np.zeros((4, 2, 1), np.float32)],
                                  [np.zeros((4, 2, 1), np.uint8), np.zeros((1, 1, 1), np.uint8)]])
def test_mip_levels_of_the_wrong_size_or_type_are_refused(thread: GLThread, mips: list[np.ndarray]) -> None:
    with pytest.raises(UmbrageError, match="mip level"):
        thread.call(lambda gl: gl.texture2d(np.zeros((8, 4, 1), np.uint8), mips=mips))


def test_a_texture_beyond_the_machine_is_refused_with_its_limit(thread: GLThread) -> None:
    limit = thread.call(lambda gl: gl.ctx.info["GL_MAX_3D_TEXTURE_SIZE"])
    data = np.zeros((1, 1, limit + 1), np.uint8)
    with pytest.raises(LimitError, match=str(limit)):
        thread.call(lambda gl: gl.texture3d(data))
