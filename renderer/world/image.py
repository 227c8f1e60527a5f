"""Pictures out: linear radiance as a screen shows it, and as files keep it.

A picture is (height, width, 4) float32, linear and premultiplied, row 0 at the top. `image_files` reads pictures in.
"""

from __future__ import annotations

import io

import imagecodecs
import numpy as np
import OpenEXR
from numpy.typing import NDArray
from PIL import Image

from renderer.core.errors import InputError
from renderer.world.state import ToneCurve

FORMATS = ("png", "png16", "jpeg", "exr", "hdr", "npy")
"""What `save_image` writes: png, png16 and jpeg as displayed, exr, hdr and npy as linear radiance."""

MEDIA_TYPES: dict[str, str] = {
    "png": "image/png",
    "png16": "image/png",
    "jpeg": "image/jpeg",
    "exr": "image/x-exr",
    "hdr": "image/vnd.radiance",
    "npy": "application/x-npy",
}
"""Media type of each format, for HTTP."""

JPEG_QUALITY = 90
"""Quality of exported JPEG files: no visible loss at normal size."""

BRIGHTEST = 1e4
"""Light above this is white under both curves; cut, so that squares do not overflow (as in lib/display.glsl)."""


def filmic(x: NDArray) -> NDArray:
    """Display light in [0, 1] of radiance after exposure (Narkowicz 2015, ACES filmic tone mapping curve)."""
    return np.clip(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0)


def srgb_encode(light: NDArray) -> NDArray:
    """sRGB code in [0, 1] of linear display light, cut to [0, 1] (IEC 61966-2-1)."""
    u = np.clip(light, 0.0, 1.0)
    return np.where(u <= 0.0031308, 12.92 * u, 1.055 * np.maximum(u, 0.0031308) ** (1.0 / 2.4) - 0.055)


def srgb_decode(code: NDArray) -> NDArray:
    """Linear light of sRGB codes in [0, 1] (IEC 61966-2-1)."""
    return np.where(code <= 0.04045, code / 12.92, ((np.maximum(code, 0.04045) + 0.055) / 1.055) ** 2.4)


def _shown(linear: NDArray, exposure_ev: float, curve: ToneCurve, background: tuple[float, float, float]) -> NDArray:
    pixels = np.asarray(linear, dtype=np.float64)
    if pixels.ndim != 3 or pixels.shape[2] not in (3, 4):
        raise InputError("image", f"has shape {pixels.shape}", "height x width x 3 or 4")
    light = np.clip(pixels[..., :3] * 2.0**exposure_ev, 0.0, BRIGHTEST)
    light = filmic(light) if curve == "filmic" else np.minimum(light, 1.0)
    if pixels.shape[2] == 4:
        light = light + (1.0 - np.clip(pixels[..., 3:], 0.0, 1.0)) * np.asarray(background)
    return srgb_encode(light)


def dither(height: int, width: int) -> NDArray[np.float64]:
    """What is added to each pixel's sRGB codes before they are rounded, (height, width, 1) in codes.

    Twin of `display_dither` in `shaders/lib/display.glsl` (Bayer 1973): sixteen values of mean zero in every square of
    four pixels.
    """
    two = np.array([[0, 2], [3, 1]])
    four = np.block([[4 * two, 4 * two + 2], [4 * two + 3, 4 * two + 1]])
    return ((np.tile(four, (height // 4 + 1, width // 4 + 1))[:height, :width] + 0.5) / 16.0 - 0.5)[..., None]


def display(
    linear: NDArray,
    exposure_ev: float,
    curve: ToneCurve = "filmic",
    background: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> NDArray[np.uint8]:
    """The displayed picture of a linear one: twin of `shaders/lib/display.glsl`, equal to one code value.

    Args:
        linear: (height, width, 3 or 4) premultiplied radiance.
        exposure_ev: EV; radiance is multiplied by 2 to this power.
        curve: tone curve.
        background: linear display light in [0, 1] that shows through where alpha is below one.

    Returns:
        (height, width, 3) sRGB codes, dithered.

    Raises:
        InputError: an array of another shape.
    """
    codes = _shown(linear, exposure_ev, curve, background) * 255.0
    return np.floor(codes + dither(*codes.shape[:2]) + 0.5).astype(np.uint8)


def encode_rgb8(rgb8: NDArray[np.uint8], format: str, quality: int = JPEG_QUALITY) -> bytes:  # noqa: A002
    """A displayed picture as a PNG (lossless) or JPEG file.

    Args:
        rgb8: (height, width, 3) sRGB codes, row 0 at the top.
        format: "png" or "jpeg".
        quality: of JPEG, 1 to 100.
    """
    out = io.BytesIO()
    picture = Image.fromarray(np.ascontiguousarray(rgb8))
    if format == "jpeg":
        picture.save(out, "jpeg", quality=quality)
    else:
        picture.save(
            out, "png", compress_level=1
        )  # a stream waits for it; level 6 saves a fifth and takes four times as long
    return out.getvalue()


def save_image(
    format: str,  # noqa: A002 - the door's own word
    picture: NDArray,
    exposure_ev: float = 0.0,
    curve: ToneCurve = "filmic",
    background: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> bytes:
    """A picture as a file's bytes.

    Args:
        format: png, jpeg and png16 hold the displayed picture (8, 8 and 16 bits); exr and npy (float32 RGBA,
            premultiplied) and hdr (RGB with a shared exponent, over black) hold radiance, whatever the exposure.
        picture: (height, width, 4) premultiplied radiance; or (height, width, 3) uint8, as displayed, for png and jpeg.
        exposure_ev, curve, background: as in `display`, from radiance to displayed formats.

    Raises:
        InputError: a format that is not written, or an array of another shape.
    """
    if format not in FORMATS:
        raise InputError("format", "this format is not written", ", ".join(FORMATS))
    if picture.dtype == np.uint8 and picture.ndim == 3 and picture.shape[2] == 3 and format in ("png", "jpeg"):
        return encode_rgb8(picture, format)
    pixels = np.ascontiguousarray(picture, dtype=np.float32)
    if picture.dtype.kind != "f" or pixels.ndim != 3 or pixels.shape[2] != 4:
        raise InputError("image", f"is {picture.dtype} of shape {pixels.shape}", "float, height x width x 4")
    if format == "npy":
        out = io.BytesIO()
        np.save(out, pixels, allow_pickle=False)
        return out.getvalue()
    if format == "exr":
        out = io.BytesIO()
        header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
        OpenEXR.File(header, {"RGBA": pixels}).write(out)
        return out.getvalue()
    if format == "hdr":
        return bytes(imagecodecs.rgbe_encode(np.ascontiguousarray(np.maximum(pixels[..., :3], 0.0))))
    if format == "png16":
        codes = np.floor(_shown(pixels, exposure_ev, curve, background) * 65535.0 + 0.5).astype(np.uint16)
        return bytes(imagecodecs.png_encode(codes, level=1))
    return encode_rgb8(display(pixels, exposure_ev, curve, background), format)
