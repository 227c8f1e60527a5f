"""Targets read back upright, samples average to the bit, and the display pass equals its numpy twin."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.core.errors import LimitError, UmbrageError
from renderer.gl.context import GL
from renderer.gl.probe import probe
from renderer.gl.source import assemble
from renderer.gl.targets import CURVES, Accumulator, Target, ToneMap, run_fullscreen
from renderer.gl.thread import GLThread
from renderer.world.image import display

RNG = np.random.default_rng(11)
PLACE = assemble(["lib/pixel.glsl"], declarations="uniform vec2 picture_size; layout(location = 0) out vec4 shown;",
                 body="void main() { shown = vec4(picture_pixel(gl_FragCoord.xy, picture_size), 7.0, 1.0); }")


def upload(gl: GL, picture: np.ndarray) -> object:
    """A texture of a picture whose row 0 is the top, as a drawn one lies in memory."""
    return gl.texture2d(np.ascontiguousarray(picture[::-1], np.float32), filter="nearest")


@pytest.mark.parametrize(("dtype", "components"), [("f4", 4), ("f4", 1), ("f2", 4), ("f2", 2)])
def test_the_top_left_pixel_comes_first(thread: GLThread, dtype: str, components: int) -> None:
    def job(gl: GL) -> np.ndarray:
        target = Target(gl, 5, 3, dtype, components)
        target.use()
        run_fullscreen(gl, PLACE, {}, {"picture_size": (5, 3)})
        read = target.read()
        target.release()
        return read
    read = thread.call(job)
    assert read.shape == (3, 5, components)
    assert read.flags.c_contiguous
    x, y = np.meshgrid(np.arange(5) + 0.5, np.arange(3) + 0.5)
    expected = np.stack([x, y, np.full((3, 5), 7), np.ones((3, 5))], axis=-1)
    np.testing.assert_array_equal(read, expected[..., :components])


def test_a_resized_target_is_drawn_whole_and_leaves_nothing_behind(thread: GLThread) -> None:
    def job(gl: GL) -> list[np.ndarray]:
        target = Target(gl, 2, 2, depth=True)
        before, read = gl.live_objects(), []
        for size in ((2, 2), (7, 4), (1, 9), (1, 9)):
            target.resize(*size)
            target.use()
            target.clear()
            run_fullscreen(gl, PLACE, {}, {"picture_size": size})
            read.append(target.read())
        assert gl.live_objects()["Texture"] == before["Texture"]
        target.release()
        return read
    for picture in thread.call(job):
        assert (picture[..., 2] == 7).all()
        assert picture[-1, -1, 1] == picture.shape[0] - 0.5


def test_a_cleared_target_is_zero(thread: GLThread) -> None:
    def job(gl: GL) -> np.ndarray:
        target = Target(gl, 3, 2)
        target.use()
        run_fullscreen(gl, PLACE, {}, {"picture_size": (3, 2)})
        target.clear()
        read = target.read()
        target.release()
        return read
    assert not thread.call(job).any()


@pytest.mark.parametrize("size", [(0, 4), (4, 0), (-1, 4), (100_000, 4), (4, 100_000)])
def test_a_size_that_cannot_be_drawn_is_refused_with_its_limit(thread: GLThread, size: tuple[int, int]) -> None:
    with pytest.raises(LimitError, match=r"1 to [0-9]+ a side"):
        thread.call(lambda gl: Target(gl, *size))


def test_the_mean_is_the_float32_sum_in_order_over_the_count(thread: GLThread) -> None:
    """Values of very unlike size, so that another order of addition gives other bits."""
    pictures = (RNG.random((9, 4, 6, 4)) * 10.0 ** RNG.integers(-4, 4, (9, 4, 6, 4))).astype(np.float32)
    total = pictures[0].copy()
    for picture in pictures[1:]:
        total += picture
    backwards = pictures[::-1].copy()
    other = backwards[0].copy()
    for picture in backwards[1:]:
        other += picture
    assert (total != other).any(), "the test would not notice another order"

    def job(gl: GL, looking: bool) -> tuple[np.ndarray, np.ndarray]:
        accumulator = Accumulator(gl, 6, 4)
        for index, picture in enumerate(pictures):
            texture = upload(gl, picture)
            accumulator.add(texture, index)
            texture.release()
            if looking:
                accumulator.read_mean()
                assert accumulator.mean_texture.size == (6, 4)
        mean = accumulator.read_mean()
        drawn = np.frombuffer(accumulator.mean_texture.read(), np.float32).reshape(4, 6, 4)[::-1]
        accumulator.release()
        return mean, drawn
    quiet, drawn = thread.call(job, False)
    watched, _ = thread.call(job, True)
    np.testing.assert_array_equal(quiet, total / np.float32(9))
    np.testing.assert_array_equal(watched, quiet)
    np.testing.assert_allclose(drawn, quiet, rtol=2e-7)


def test_sample_zero_starts_afresh_and_others_must_come_in_turn(thread: GLThread) -> None:
    def job(gl: GL) -> tuple[np.ndarray, np.ndarray]:
        accumulator = Accumulator(gl, 2, 2)
        with pytest.raises(UmbrageError, match="no sample"):
            accumulator.read_mean()
        with pytest.raises(UmbrageError, match="sample 1 came after 0"):
            accumulator.add(accumulator.sum_texture, 1)
        ones, fives = upload(gl, np.ones((2, 2, 4))), upload(gl, np.full((2, 2, 4), 5.0))
        accumulator.add(ones, 0)
        assert np.frombuffer(accumulator.mean_texture.read(), np.float32)[0] == 1
        accumulator.add(fives, 1)
        for wrong in (1, 3):
            with pytest.raises(UmbrageError, match="came after 2"):
                accumulator.add(ones, wrong)
        mean = accumulator.read_mean()
        accumulator.add(fives, 0)
        assert accumulator.samples == 1
        assert np.frombuffer(accumulator.mean_texture.read(), np.float32)[0] == 5
        again = accumulator.read_mean()
        for made in (ones, fives, accumulator):
            made.release()
        return mean, again
    mean, again = thread.call(job)
    assert (mean == 3).all()
    assert (again == 5).all()


def test_a_resized_accumulator_has_no_samples_and_takes_only_its_size(thread: GLThread) -> None:
    def job(gl: GL) -> None:
        accumulator = Accumulator(gl, 2, 2)
        small, wide = upload(gl, np.ones((2, 2, 4))), upload(gl, np.ones((2, 3, 4)))
        with pytest.raises(UmbrageError, match="cannot be added"):
            accumulator.add(wide, 0)
        accumulator.add(small, 0)
        assert accumulator.mean_texture.size == (2, 2)
        accumulator.resize(3, 2)
        with pytest.raises(UmbrageError, match="no sample"):
            _ = accumulator.mean_texture
        accumulator.add(wide, 0)
        assert accumulator.mean_texture.size == accumulator.size == (3, 2)
        for made in (small, wide, accumulator):
            made.release()
    thread.call(job)


def shown(gl: GL, picture: np.ndarray, **options: object) -> np.ndarray:
    texture, tone = upload(gl, picture), ToneMap(gl)
    tone.draw(texture, **options)
    read = tone.read_rgb8()
    texture.release()
    tone.release()
    return read


def scene() -> np.ndarray:
    """Radiances over eleven decades, both signs, every opacity; alpha in the last component."""
    picture = RNG.random((64, 48, 4)) * 10.0 ** RNG.uniform(-6, 5, (64, 48, 1))
    picture[0] *= -1
    picture[1, :, :3] = 0
    picture[..., 3] = np.linspace(0, 1, 48)
    return picture.astype(np.float32)


@pytest.mark.parametrize("curve", ["filmic", "linear"])
@pytest.mark.parametrize("exposure_ev", [-7.5, 0.0, 3.25])
@pytest.mark.parametrize("background", [(0.0, 0.0, 0.0), (1.0, 1.0, 1.0), (0.2, 0.5, 0.9)])
def test_the_display_pass_equals_its_twin_to_one_code(thread: GLThread, curve: str, exposure_ev: float,
                                                      background: tuple[float, float, float]) -> None:
    """Spent: float32 powers and products of the rasteriser, where a value lies at the edge of two codes."""
    picture = scene()
    read = thread.call(shown, picture, curve=curve, exposure_ev=exposure_ev, background=background)
    wanted = display(picture, exposure_ev, curve, background)
    difference = np.abs(read.astype(int) - wanted.astype(int))
    assert difference.max() <= 1
    assert (difference > 0).mean() < 0.01


def test_the_tone_curve_is_the_published_one(thread: GLThread) -> None:
    """Narkowicz 2015 in float64; black stays black, 1 is reached at 7.24 and never passed, and it never falls."""
    x = np.concatenate([[0.0], np.logspace(-5, 30, 400)])
    read = thread.call(probe, ["lib/display.glsl"], "display_curve(vec3(x), DISPLAY_FILMIC).r", {"x": x}, 1)[:, 0]
    capped = np.minimum(x, 1e4)
    wanted = np.clip(capped * (2.51 * capped + 0.03) / (capped * (2.43 * capped + 0.59) + 0.14), 0, 1)
    np.testing.assert_allclose(read, wanted, rtol=3e-6)
    assert read[0] == 0
    assert (np.diff(read) >= 0).all()
    assert (read[x > 7.25] == 1).all()
    assert read[x < 7.0].max() < 1


def test_srgb_is_the_standard_one(thread: GLThread) -> None:
    """IEC 61966-2-1, with both of its pieces, ends and middle grey: 0.214 is code 0.5."""
    u = np.concatenate([[0.0, 0.0031308, 0.214041, 1.0, 2.0, -1.0], np.linspace(0, 1, 500)])
    read = thread.call(probe, ["lib/display.glsl"], "display_srgb(vec3(u)).g", {"u": u}, 1)[:, 0]
    v = np.clip(u, 0, 1)
    wanted = np.where(v <= 0.0031308, 12.92 * v, 1.055 * np.maximum(v, 1e-9) ** (1 / 2.4) - 0.055)
    np.testing.assert_allclose(read, wanted, atol=2e-5)  # the rasteriser's pow; a code is 4e-3
    assert read[[0, 3, 4, 5]] == pytest.approx([0, 1, 1, 0], abs=1e-6)


def test_white_shows_through_as_white_at_any_exposure(thread: GLThread) -> None:
    for exposure_ev in (-10.0, 0.0, 10.0):
        read = thread.call(shown, np.zeros((2, 2, 4)), exposure_ev=exposure_ev, background=(1.0, 1.0, 1.0))
        assert (read == 255).all()


def test_the_sum_of_samples_shows_as_their_mean(thread: GLThread) -> None:
    picture = scene()
    one = thread.call(shown, picture, curve="filmic")
    assert (thread.call(shown, picture * 4, curve="filmic", samples=4) == one).all()
    assert (thread.call(shown, picture * 4, curve="filmic") != one).any()


def test_the_shown_picture_has_its_top_row_first_whatever_was_bound_before(thread: GLThread) -> None:
    picture = np.zeros((3, 2, 4), np.float32)
    picture[0, 1, 0] = picture[2, 0, 1] = 1.0

    def job(gl: GL) -> np.ndarray:
        tone, big, small = ToneMap(gl), upload(gl, np.ones((9, 9, 4))), upload(gl, picture)
        with pytest.raises(UmbrageError, match="no picture"):
            tone.read_rgb8()
        tone.draw(big)
        tone.draw(small, curve="linear")
        read = tone.read_rgb8()
        for made in (tone, big, small):
            made.release()
        return read
    read = thread.call(job)
    assert read.shape == (3, 2, 3)
    assert read.dtype == np.uint8
    np.testing.assert_array_equal(read, (picture[..., :3] * 255).astype(np.uint8))


def test_no_radiance_however_odd_makes_a_wrong_code(thread: GLThread) -> None:
    """Infinite radiance is white and negative black."""
    picture = np.zeros((1, 3, 4), np.float32)
    picture[0, :, 0] = [np.inf, -np.inf, -1.0]
    for curve in CURVES:
        assert thread.call(shown, picture, curve=curve)[0, :, 0].tolist() == [255, 0, 0]
