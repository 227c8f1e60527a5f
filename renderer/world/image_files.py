"""Pictures in: a user's own file as linear, premultiplied RGBA, nothing believed before its header was measured."""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Literal

import imagecodecs
import numpy as np
import OpenEXR
from numpy.typing import NDArray
from PIL import Image

from renderer.core.errors import AssetError, LimitError
from renderer.world.image import srgb_decode
from renderer.world.limits import DEFAULT_LIMITS, Limits

Colour = Literal["srgb", "linear"]

MAGIC: tuple[tuple[bytes, str], ...] = (
    (b"\x89PNG\r\n\x1a\n", "png"),
    (b"\xff\xd8\xff", "jpeg"),
    (b"\x76\x2f\x31\x01", "exr"),
    (b"#?", "hdr"),
    (b"\x93NUMPY", "npy"),
)
"""First bytes of the formats that are read; a file's name is not believed."""

LONGEST = 1 << 16
"""Largest side of a picture, in pixels."""


def load_image(path: Path, limits: Limits = DEFAULT_LIMITS, colour: Colour = "srgb") -> NDArray[np.float32]:
    """A picture from a PNG (8 or 16 bits), JPEG, Radiance HDR, OpenEXR or .npy file.

    Args:
        path: the file.
        limits: bounds of its size in bytes and pixels.
        colour: what the codes of PNG and JPEG stand for: "srgb" colours, or "linear" values, as in a map of quantities.
            The other formats are linear already.

    Returns:
        (height, width, 4) float32, linear and premultiplied, row 0 at the top; alpha is one where the file has none.
        PNG alpha is straight and is multiplied in; that of EXR and .npy is taken as premultiplied.

    Raises:
        AssetError: a file that is damaged, truncated, of another format, or holds NaN or infinite values.
        LimitError: one that is larger, or claims to be, than the limits allow.
    """
    pixels = load_codes(path, limits)
    if pixels.dtype.kind != "f":
        pixels = straight_of(pixels, colour)
        pixels[..., :3] *= pixels[..., 3:]
    with np.errstate(over="ignore"):  # float64 beyond float32 becomes infinite, and is refused as such
        result = _rgba(pixels)
    if not np.isfinite(result).all():
        raise AssetError("file", "holds values that are not finite numbers")
    return result


def load_codes(path: Path, limits: Limits = DEFAULT_LIMITS) -> NDArray:
    """A picture's numbers as its file has them, (height, width, channels): codes of PNG and JPEG, values of the others.

    Raises:
        AssetError, LimitError: as `load_image`, but for values that are not finite.
    """
    try:
        size = path.stat().st_size
        if size > limits.file_bytes:
            raise LimitError("file", f"has {size:,} bytes", f"at most {limits.file_bytes:,} bytes")
        data = path.read_bytes()
    except OSError as failure:
        raise AssetError("file", "cannot be read") from failure
    return codes_of(data, limits)


def codes_of(data: bytes, limits: Limits = DEFAULT_LIMITS) -> NDArray:
    """The same of a file's bytes."""
    kind = next((name for magic, name in MAGIC if data.startswith(magic)), None)
    if kind is None:
        raise AssetError("file", "is no picture of a known format", "PNG, JPEG, Radiance HDR, OpenEXR, .npy")
    return _READERS[kind](data, limits)


def straight_of(codes: NDArray, colour: Colour = "srgb") -> NDArray[np.float32]:
    """Linear straight colour and alpha, (height, width, 4), of the codes of a PNG or JPEG picture."""
    pixels = codes.astype(np.float64) / np.iinfo(codes.dtype).max
    return _rgba(_decode_colours(pixels) if colour == "srgb" else pixels)


def _decode_colours(pixels: NDArray) -> NDArray:
    """Linear light of the colour channels; alpha, the second of two or the fourth of four, is linear as it is."""
    colours = pixels.shape[2] - (pixels.shape[2] in (2, 4))
    return np.concatenate([srgb_decode(pixels[..., :colours]), pixels[..., colours:]], axis=2)


def _rgba(pixels: NDArray) -> NDArray[np.float32]:
    """One channel is grey, two are grey and alpha, three are RGB, four are RGBA."""
    channels = pixels.shape[2]
    if channels in (1, 2):
        pixels = np.concatenate([np.repeat(pixels[..., :1], 3, axis=2), pixels[..., 1:]], axis=2)
    if channels in (1, 3):
        pixels = np.concatenate([pixels, np.ones_like(pixels[..., :1])], axis=2)
    return np.ascontiguousarray(pixels, dtype=np.float32)


def _measured(width: int, height: int, limits: Limits) -> None:
    if width < 1 or height < 1:
        raise AssetError("file", f"claims {width} x {height} pixels", "at least 1 x 1")
    if width > LONGEST or height > LONGEST or width * height > limits.texture_pixels:
        most = f"at most {limits.texture_pixels:,} pixels and {LONGEST} a side"
        raise LimitError("file", f"claims {width} x {height} pixels", most)


def _damaged(kind: str) -> AssetError:
    return AssetError("file", f"is a damaged or truncated {kind} file")


def _png(data: bytes, limits: Limits) -> NDArray:
    if len(data) < 33 or data[12:16] != b"IHDR":
        raise _damaged("PNG")
    _measured(int.from_bytes(data[16:20], "big"), int.from_bytes(data[20:24], "big"), limits)
    try:
        pixels = imagecodecs.png_decode(data)
    except (imagecodecs.PngError, ValueError, RuntimeError, MemoryError) as failure:
        raise _damaged("PNG") from failure
    return pixels[..., None] if pixels.ndim == 2 else pixels


def _jpeg(data: bytes, limits: Limits) -> NDArray:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)  # our own bound follows
            picture = Image.open(io.BytesIO(data), formats=["JPEG"])
        _measured(picture.width, picture.height, limits)
        return np.asarray(picture.convert("L" if picture.mode == "L" else "RGB")).reshape(
            picture.height, picture.width, -1
        )
    except Image.DecompressionBombError as failure:  # Pillow's own bound stands whatever ours is
        raise LimitError("file", "claims too many pixels", f"at most {limits.texture_pixels:,} pixels") from failure
    except (OSError, ValueError, SyntaxError) as failure:
        raise _damaged("JPEG") from failure


def _hdr(data: bytes, limits: Limits) -> NDArray:
    size = re.search(rb"\n-Y (\d{1,9}) \+X (\d{1,9})\n", data[:8192])
    if size is None:
        raise AssetError("file", "is no Radiance HDR file of the usual orientation", "-Y height +X width")
    _measured(int(size[2]), int(size[1]), limits)
    try:
        return imagecodecs.rgbe_decode(data)
    except (imagecodecs.RgbeError, ValueError, RuntimeError, MemoryError) as failure:
        raise _damaged("Radiance HDR") from failure


def _exr(data: bytes, limits: Limits) -> NDArray:
    try:
        low, high = OpenEXR.File(io.BytesIO(data), header_only=True).header()["dataWindow"]
        _measured(int(high[0]) - int(low[0]) + 1, int(high[1]) - int(low[1]) + 1, limits)
        file = OpenEXR.File(io.BytesIO(data), separate_channels=True)
        channels = {name: channel.pixels for name, channel in file.channels().items()}
    except (RuntimeError, ValueError, KeyError, TypeError, IndexError, OSError, MemoryError) as failure:
        raise _damaged("OpenEXR") from failure
    names = ["R", "G", "B"] if "R" in channels else ["Y"]
    if "A" in channels:
        names.append("A")
    if any(name not in channels for name in names):
        raise AssetError("file", "has neither channels R, G, B nor Y")
    planes = [np.asarray(channels[name], dtype=np.float32) for name in names]
    if any(plane.shape != planes[0].shape for plane in planes):
        raise AssetError("file", "has channels of different sizes")
    return np.stack(planes, axis=2)


def _npy(data: bytes, limits: Limits) -> NDArray:
    stream = io.BytesIO(data)
    try:
        version = np.lib.format.read_magic(stream)
        readers = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
        shape, fortran, dtype = readers[version](stream)
    except (ValueError, SyntaxError, TypeError, KeyError, EOFError, RecursionError, MemoryError) as failure:
        raise _damaged(".npy") from failure
    if dtype.kind != "f" or len(shape) not in (2, 3) or (len(shape) == 3 and shape[2] not in (1, 2, 3, 4)):
        raise AssetError("file", f"holds {dtype} values of shape {shape}", "floats, height x width (x 1 to 4)")
    _measured(shape[1], shape[0], limits)
    expected = int(np.prod(shape)) * dtype.itemsize
    body = data[stream.tell() :]
    if len(body) != expected:
        raise AssetError("file", f"has {len(body):,} bytes of pixels where its header claims {expected:,}")
    pixels = np.frombuffer(body, dtype=dtype).reshape(shape, order="F" if fortran else "C")
    return pixels[..., None] if pixels.ndim == 2 else pixels


_READERS: dict[str, Callable[[bytes, Limits], NDArray]] = {
    "png": _png,
    "jpeg": _jpeg,
    "hdr": _hdr,
    "exr": _exr,
    "npy": _npy,
}
