"""Pictures out and in: the screen's curve, round trips, and files that lie about themselves."""

from __future__ import annotations

import io
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path

import imagecodecs
import numpy as np
import OpenEXR
import pytest
from PIL import Image

from renderer.core.errors import AssetError, InputError, LimitError
from renderer.gl.targets import ToneMap
from renderer.gl.thread import GL, GLThread
from renderer.world.image import (
    FORMATS,
    MEDIA_TYPES,
    display,
    dither,
    encode_rgb8,
    filmic,
    save_image,
    srgb_decode,
    srgb_encode,
)
from renderer.world.image_files import load_image
from renderer.world.limits import Limits


@pytest.fixture
def picture() -> np.ndarray:
    """Premultiplied radiance from dark to far above white, every alpha, asymmetric in both axes."""
    random = np.random.default_rng(5)
    rgba = random.random((13, 17, 4)).astype(np.float32)
    rgba[..., :3] *= rgba[..., 3:] * 10.0 ** random.uniform(-3, 1.5, (13, 17, 1)).astype(np.float32)
    return rgba


def _load(tmp_path: Path, data: bytes, **options: object) -> np.ndarray:
    path = tmp_path / "file"
    path.write_bytes(data)
    return load_image(path, **options)  # type: ignore[arg-type]


def test_display_at_known_values() -> None:
    """Black is 0, white 255; one stop doubles; mid grey of sRGB (0.2140) is 127.5; filmic follows its formula."""
    grey = np.full((1, 1, 3), 0.21404114, np.float32)
    assert display(np.zeros((1, 1, 3)), 0.0, "linear").max() == 0
    assert display(np.ones((1, 1, 3)), 0.0, "linear").min() == 255
    assert display(grey / 2, 1.0, "linear").ravel().tolist() == display(grey, 0.0, "linear").ravel().tolist()
    assert abs(int(display(grey, 0.0, "linear")[0, 0, 0]) - 127.5) <= 0.5
    assert filmic(np.array([0.0, 1.0, 1e4])) == pytest.approx([0.0, 2.54 / 3.16, 1.0])
    assert display(np.full((1, 1, 3), 1e30), 20.0).min() == 255
    assert display(np.full((1, 1, 3), -5.0), 0.0).max() == 0


def test_srgb_and_its_inverse_compose_to_nothing() -> None:
    """Both branches, and the joint between them."""
    x = np.concatenate([np.linspace(0, 1, 1001), [0.0031308, 0.04045]])
    np.testing.assert_allclose(srgb_decode(srgb_encode(x)), x, atol=2e-7)


def test_what_is_behind_shows_after_the_curve() -> None:
    """A clear pixel over white is white at every exposure; a half covered one mixes in display light."""
    clear = np.zeros((1, 1, 4), np.float32)
    assert display(clear, -10.0, "filmic", (1.0, 1.0, 1.0)).min() == 255
    half = np.full((4, 4, 4), [0.0, 0.0, 0.0, 0.5], np.float32)
    assert display(half, 0.0, "linear", (1.0, 1.0, 1.0)).mean() == pytest.approx(187.516, abs=1 / 16)  # sRGB's of 0.5


def test_a_slow_gradient_shows_no_bands() -> None:
    """Of three codes over 24 squares of four pixels, each is right to a sixteenth in the mean; whole codes stay so."""
    wanted = np.linspace(214, 217, 24)
    codes = np.tile(wanted.repeat(4)[None, :, None], (4, 1, 3))
    squares = display(srgb_decode(codes / 255), 0.0, "linear").reshape(4, 24, 4, 3).mean(axis=(0, 2, 3))
    assert np.abs(squares - wanted).max() < 1 / 16
    assert np.abs(np.round(wanted) - wanted).max() > 0.4, "which rounding alone misses"
    every = np.tile(np.arange(256.0)[None, :, None], (4, 1, 3))
    np.testing.assert_array_equal(display(srgb_decode(every / 255), 0.0, "linear"), every)


@pytest.mark.parametrize("curve", ["linear", "filmic"])
def test_the_shader_shows_the_same(picture: np.ndarray, curve: str) -> None:
    """The tone-mapping pass equals its twin to one code value, and a wrong exposure does not."""

    def run(gl: GL) -> np.ndarray:
        texture, pass_ = gl.texture2d(np.ascontiguousarray(picture[::-1])), ToneMap(gl)
        try:
            pass_.draw(texture, exposure_ev=-1.3, curve=curve, background=(0.2, 0.5, 1.0))  # type: ignore[arg-type]
            return pass_.read_rgb8()
        finally:
            texture.release()
            pass_.release()

    with GLThread() as thread:
        shown = np.asarray(thread.call(run)).astype(int)
    assert np.abs(shown - display(picture, -1.3, curve, (0.2, 0.5, 1.0))).max() <= 1  # type: ignore[arg-type]
    assert np.abs(shown - display(picture, -1.0, curve, (0.2, 0.5, 1.0))).max() > 5  # type: ignore[arg-type]


@pytest.mark.parametrize(("name", "tolerance"), [("exr", 0.0), ("npy", 0.0), ("hdr", 1 / 128)])
def test_radiance_survives_its_file(picture: np.ndarray, tmp_path: Path, name: str, tolerance: float) -> None:
    """EXR and .npy keep every bit and alpha; HDR keeps RGB to 1/128 of the pixel's largest channel, over black."""
    back = _load(tmp_path, save_image(name, picture, exposure_ev=3.0))
    largest = picture[..., :3].max(axis=2, keepdims=True)
    assert (np.abs(back[..., :3] - picture[..., :3]) <= tolerance * largest).all()
    np.testing.assert_array_equal(back[..., 3], 1.0 if name == "hdr" else picture[..., 3])


def test_displayed_pictures_survive_their_file(picture: np.ndarray, tmp_path: Path) -> None:
    """PNG keeps the codes of `display`; 16 bits, dithered, round to 8; JPEG keeps a smooth picture to 3 codes."""
    codes = display(picture, -1.0)
    png = np.asarray(Image.open(io.BytesIO(save_image("png", picture, -1.0))))
    np.testing.assert_array_equal(png, codes)
    assert save_image("png", codes) == save_image("png", picture, -1.0)
    deep = imagecodecs.png_decode(save_image("png16", picture, -1.0))
    assert deep.dtype == np.uint16
    assert np.abs(deep / 257.0 + dither(13, 17) - codes).max() <= 0.51
    ramp = np.broadcast_to(np.linspace(20, 220, 32, dtype=np.uint8)[:, None, None], (32, 32, 3))
    jpeg = np.asarray(Image.open(io.BytesIO(encode_rgb8(np.ascontiguousarray(ramp), "jpeg", 95))))
    assert np.abs(jpeg.astype(int) - ramp).max() <= 3
    np.testing.assert_allclose(
        _load(tmp_path, save_image("png", picture, -1.0))[..., :3], srgb_decode(codes / 255.0), atol=1e-6
    )


def test_straight_alpha_is_multiplied_in(tmp_path: Path) -> None:
    """A PNG's alpha is straight and linear; its colours are sRGB unless the file holds quantities."""
    data = bytes(imagecodecs.png_encode(np.array([[[255, 0, 188, 128]]], np.uint8)))
    alpha = 128 / 255
    np.testing.assert_allclose(
        _load(tmp_path, data)[0, 0], [alpha, 0, alpha * srgb_decode(np.array(188 / 255)), alpha], rtol=1e-6
    )
    np.testing.assert_allclose(_load(tmp_path, data, colour="linear")[0, 0, 2], alpha * 188 / 255, rtol=1e-6)


def test_grey_files_become_rgba(tmp_path: Path) -> None:
    """8 and 16 bits, grey alone and grey with alpha."""
    deep = bytes(imagecodecs.png_encode(np.array([[0, 32768, 65535]], np.uint16)))
    np.testing.assert_allclose(_load(tmp_path, deep, colour="linear")[0, :, 1], [0, 32768 / 65535, 1], rtol=1e-6)
    pair = bytes(imagecodecs.png_encode(np.array([[[255, 51]]], np.uint8)))
    np.testing.assert_allclose(_load(tmp_path, pair)[0, 0], [0.2] * 4, rtol=1e-6)


def test_every_format_has_a_media_type_and_others_are_refused(picture: np.ndarray) -> None:
    """Formats are named; a wrong one, or a picture of the wrong shape, is answered in words."""
    assert set(MEDIA_TYPES) == set(FORMATS)
    with pytest.raises(InputError, match="png"):
        save_image("bmp", picture)
    with pytest.raises(InputError, match="uint8"):
        save_image("exr", display(picture, 0.0))
    with pytest.raises(InputError, match="shape"):
        save_image("exr", picture[..., 0])
    with pytest.raises(InputError, match="shape"):
        display(picture[..., :2], 0.0)


def _chunk(kind: bytes, body: bytes) -> bytes:
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


def _bombs() -> Iterator[tuple[str, bytes]]:
    header = struct.pack(">IIBBBBB", 60000, 60000, 8, 6, 0, 0, 0)
    yield (
        "png",
        b"\x89PNG\r\n\x1a\n"
        + _chunk(b"IHDR", header)
        + _chunk(b"IDAT", zlib.compress(bytes(1 << 20)))
        + _chunk(b"IEND", b""),
    )
    small = bytearray(encode_rgb8(np.zeros((8, 8, 3), np.uint8), "jpeg"))
    frame = small.index(b"\xff\xc0")
    small[frame + 5 : frame + 9] = struct.pack(">HH", 65000, 65000)
    yield "jpeg", bytes(small)
    yield "hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 60000 +X 60000\n" + bytes(64)
    head = b"{'descr': '<f4', 'fortran_order': False, 'shape': (60000, 60000, 4), }"
    head += b" " * (118 - len(head)) + b"\n"
    yield "npy", b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head + bytes(64)
    out = io.BytesIO()
    OpenEXR.File({"type": OpenEXR.scanlineimage}, {"RGBA": np.zeros((4, 4, 4), np.float32)}).write(out)
    exr = bytearray(out.getvalue())
    window = exr.index(b"dataWindow\x00box2i\x00") + len(b"dataWindow\x00box2i\x00") + 4
    exr[window + 8 : window + 16] = struct.pack("<ii", 59999, 59999)
    yield "exr", bytes(exr)


@pytest.mark.parametrize(("kind", "data"), list(_bombs()), ids=lambda v: v if isinstance(v, str) else "")
def test_a_file_that_claims_too_much_is_refused_before_it_is_opened(tmp_path: Path, kind: str, data: bytes) -> None:
    """60000 x 60000 in a few bytes: the claim itself is refused."""
    with pytest.raises(LimitError, match="claims"):
        _load(tmp_path, data)


@pytest.mark.parametrize("name", FORMATS)
def test_truncated_files_are_refused(picture: np.ndarray, tmp_path: Path, name: str) -> None:
    """Cut anywhere, a file is called damaged; nothing else escapes."""
    noise = np.random.default_rng(2).random((40, 40, 4)).astype(np.float32)
    whole = save_image(name, noise)
    for kept in (3, 12, 40, len(whole) // 2, len(whole) - 30):
        with pytest.raises(AssetError):
            _load(tmp_path, whole[:kept])


def test_random_bytes_after_a_true_beginning_are_refused_or_read(picture: np.ndarray, tmp_path: Path) -> None:
    """Damage in the middle of a file gives a picture or a named error, never another exception."""
    random = np.random.default_rng(11)
    refused = 0
    for name in FORMATS:
        whole = np.frombuffer(save_image(name, picture), np.uint8)
        for _ in range(25):
            damaged = whole.copy()
            places = random.integers(8, len(damaged), 6)
            damaged[places] = random.integers(0, 256, 6)
            try:
                assert _load(tmp_path, damaged.tobytes()).shape[2] == 4
            except (AssetError, LimitError):
                refused += 1
    assert refused > 0


def test_values_that_are_no_numbers_are_refused(picture: np.ndarray, tmp_path: Path) -> None:
    """NaN, infinities, and float64 beyond float32."""
    for bad in (np.nan, np.inf):
        broken = picture.copy()
        broken[2, 3, 1] = bad
        with pytest.raises(AssetError, match="finite"):
            _load(tmp_path, save_image("exr", broken))
    out = io.BytesIO()
    np.save(out, np.full((3, 3), 1e300))
    with pytest.raises(AssetError, match="finite"):
        _load(tmp_path, out.getvalue())


@pytest.mark.parametrize(
    "array", [np.zeros((2, 2, 5), np.float32), np.zeros(4, np.float32), np.zeros((2, 2), complex), np.array({})]
)
def test_arrays_that_are_no_pictures_are_refused(tmp_path: Path, array: np.ndarray) -> None:
    """Wrong shapes, wrong types and pickled objects."""
    out = io.BytesIO()
    np.save(out, array, allow_pickle=True)
    with pytest.raises(AssetError):
        _load(tmp_path, out.getvalue())


def test_unknown_and_missing_and_large_files_are_refused(picture: np.ndarray, tmp_path: Path) -> None:
    """By content, by absence, and by size."""
    with pytest.raises(AssetError, match="format"):
        _load(tmp_path, b"GIF89a" + bytes(50))
    with pytest.raises(AssetError, match="format"):
        _load(tmp_path, b"")
    with pytest.raises(AssetError, match="read"):
        load_image(tmp_path / "none.png")
    with pytest.raises(LimitError, match="bytes"):
        _load(tmp_path, save_image("npy", picture), limits=Limits(file_bytes=100))
    with pytest.raises(LimitError, match="pixels"):
        _load(tmp_path, save_image("png", picture), limits=Limits(texture_pixels=100))
