"""Textures from arrays: type, filter, wrapping and given mip levels in one call."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import Any, Literal

import moderngl
import numpy as np

from renderer.core.errors import LimitError, UmbrageError

Filter = Literal["nearest", "linear"]
Wrap = Literal["clamp", "repeat"]

_DTYPES = {"uint8": "f1", "float16": "f2", "float32": "f4", "uint16": "nu2", "int32": "i4", "uint32": "u4"}
_INTEGER = ("i4", "u4")
# OpenGL registry values.
_TEXTURE_3D, _TEXTURE_2D_ARRAY, _TEXTURE0, _UNPACK_ALIGNMENT = 0x806F, 0x8C1A, 0x84C0, 0x0CF5
_FORMATS = {1: 0x1903, 2: 0x8227, 3: 0x1907, 4: 0x1908}  # RED, RG, RGB, RGBA
_TYPES = {"f1": 0x1401, "f2": 0x140B, "f4": 0x1406, "nu2": 0x1403}  # UNSIGNED_BYTE, HALF_FLOAT, FLOAT, UNSIGNED_SHORT


def texture2d(ctx: moderngl.Context, data: np.ndarray, filter: Filter = "linear", wrap: Wrap = "clamp",  # noqa: A002
              mips: Sequence[np.ndarray] = ()) -> moderngl.Texture:
    """A 2D texture.

    Args:
        data: (rows, columns) or (rows, columns, components); uint8 and uint16 read as [0, 1], float as it is,
            int32 and uint32 as integers. Row 0 is at texture coordinate v = 0.
        filter: between texels, and between levels where there are `mips`.
        wrap: what lies beyond the edges.
        mips: levels 1, 2, ... of the same type, each half the size of the one before, rounded down.

    Raises:
        LimitError: larger than the machine can hold.
        UmbrageError: an array that no texture can hold.
    """
    levels = _levels(data, mips, 2)
    rows, columns, components = levels[0].shape
    _check_size(ctx, "GL_MAX_TEXTURE_SIZE", rows, columns)
    texture = ctx.texture((columns, rows), components, levels[0].tobytes(), dtype=_DTYPES[data.dtype.name], alignment=1)
    if mips:
        texture.build_mipmaps(0, len(mips))
        for number, level in enumerate(levels[1:], start=1):
            texture.write(level.tobytes(), level=number, alignment=1)
    texture.repeat_x = texture.repeat_y = wrap == "repeat"
    texture.filter = _filter(texture.dtype, filter, bool(mips))
    return texture


def texture_array(ctx: moderngl.Context, data: np.ndarray, filter: Filter = "linear",  # noqa: A002
                  wrap: Wrap = "clamp", mips: Sequence[np.ndarray] = ()) -> moderngl.TextureArray:
    """An array of 2D textures from (layers, rows, columns[, components]), all in each level; see `texture2d`."""
    levels = _levels(data, mips, 3, kept=1)
    layers, rows, columns, components = levels[0].shape
    _check_size(ctx, "GL_MAX_TEXTURE_SIZE", rows, columns)
    _check_size(ctx, "GL_MAX_ARRAY_TEXTURE_LAYERS", layers)
    texture = ctx.texture_array((columns, rows, layers), components, levels[0].tobytes(),
                                dtype=_DTYPES[data.dtype.name], alignment=1)
    if mips:
        texture.build_mipmaps(0, len(mips))
        for number, level in enumerate(levels[1:], start=1):
            _write_level(ctx, texture, number, level)
    texture.repeat_x = texture.repeat_y = wrap == "repeat"
    texture.filter = _filter(texture.dtype, filter, bool(mips))
    return texture


def texture3d(ctx: moderngl.Context, data: np.ndarray, filter: Filter = "linear",  # noqa: A002
              wrap: tuple[Wrap, Wrap, Wrap] = ("clamp", "clamp", "clamp"),
              mips: Sequence[np.ndarray] = ()) -> moderngl.Texture3D:
    """A 3D texture from (layers, rows, columns[, components]), layer 0 at w = 0; see `texture2d`.

    Args:
        wrap: beyond the edges along columns (u), rows (v) and layers (w).
    """
    levels = _levels(data, mips, 3)
    layers, rows, columns, components = levels[0].shape
    _check_size(ctx, "GL_MAX_3D_TEXTURE_SIZE", layers, rows, columns)
    dtype = _DTYPES[data.dtype.name]
    texture = ctx.texture3d((columns, rows, layers), components, levels[0].tobytes(), dtype=dtype, alignment=1)
    if mips:
        texture.build_mipmaps(0, len(mips))
        for number, level in enumerate(levels[1:], start=1):
            _write_level(ctx, texture, number, level)
    texture.repeat_x, texture.repeat_y, texture.repeat_z = (side == "repeat" for side in wrap)
    texture.filter = _filter(dtype, filter, bool(mips))
    return texture


def sampler_type(texture: Any) -> str:
    """The GLSL type that samples a texture."""
    prefix = {"i": "i", "u": "u"}.get(texture.dtype[0], "")
    kinds = {moderngl.Texture: "sampler2D", moderngl.Texture3D: "sampler3D", moderngl.TextureArray: "sampler2DArray",
             moderngl.TextureCube: "samplerCube"}
    return prefix + kinds[type(texture)]


def _levels(data: np.ndarray, mips: Sequence[np.ndarray], dimensions: int, kept: int = 0) -> list[np.ndarray]:
    """Every level with its components as last axis, checked; the first `kept` axes have the same size in all."""
    if data.dtype.name not in _DTYPES:
        raise UmbrageError(f"no texture holds {data.dtype.name}; it may be {', '.join(_DTYPES)}")
    if mips and _DTYPES[data.dtype.name] in _INTEGER:
        raise UmbrageError("textures of integers have no mip levels")
    levels = []
    for number, level in enumerate((data, *mips)):
        shaped = level[..., None] if level.ndim == dimensions else level
        halved = (max(1, side >> number) for side in data.shape[kept:dimensions])
        wanted = (*data.shape[:kept], *halved)
        if shaped.ndim != dimensions + 1 or not 1 <= shaped.shape[-1] <= 4 or 0 in shaped.shape:
            raise UmbrageError(f"a {dimensions}D texture is not made from an array of shape {level.shape}")
        if level.dtype != data.dtype or shaped.shape[:dimensions] != wanted:
            raise UmbrageError(f"mip level {number} is {level.dtype} {level.shape}, not {data.dtype} {wanted}")
        levels.append(np.ascontiguousarray(shaped))
    return levels


def _filter(dtype: str, name: Filter, mips: bool) -> tuple[int, int]:
    if name == "nearest" or dtype in _INTEGER:
        return (moderngl.NEAREST_MIPMAP_NEAREST if mips else moderngl.NEAREST), moderngl.NEAREST
    return (moderngl.LINEAR_MIPMAP_LINEAR if mips else moderngl.LINEAR), moderngl.LINEAR


def _check_size(ctx: moderngl.Context, limit: str, *sides: int) -> None:
    allowed = int(ctx.info[limit])
    if max(sides) > allowed:
        raise LimitError("size", f"a texture of {' x '.join(map(str, sides))} is more than this machine's OpenGL holds",
                         f"at most {allowed} a side")


def _write_level(ctx: moderngl.Context, texture: moderngl.Texture3D | moderngl.TextureArray, number: int,
                 level: np.ndarray) -> None:
    """Upload one mip level of a 3D texture or an array, for which moderngl has no call."""
    target = _TEXTURE_3D if isinstance(texture, moderngl.Texture3D) else _TEXTURE_2D_ARRAY
    layers, rows, columns, components = level.shape
    unit = ctx.default_texture_unit  # the one that moderngl itself binds for uploads
    pixels = level.ctypes.data_as(ctypes.c_void_p)
    _gl(ctx, "glActiveTexture", ctypes.c_uint)(_TEXTURE0 + unit)
    _gl(ctx, "glBindTexture", ctypes.c_uint, ctypes.c_uint)(target, texture.glo)
    _gl(ctx, "glPixelStorei", ctypes.c_uint, ctypes.c_int)(_UNPACK_ALIGNMENT, 1)
    upload = _gl(ctx, "glTexSubImage3D", ctypes.c_uint, *(ctypes.c_int,) * 7, *(ctypes.c_uint,) * 2, ctypes.c_void_p)
    upload(target, number, 0, 0, 0, columns, rows, layers, _FORMATS[components], _TYPES[texture.dtype], pixels)


def _gl(ctx: moderngl.Context, name: str, *arguments: Any) -> Any:
    """An OpenGL function of the current context by name."""
    address = ctx.mglo._context.load_opengl_function(name)
    return ctypes.CFUNCTYPE(None, *arguments)(address)
