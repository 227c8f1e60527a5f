"""The form in which matter is filtered and interpolated: extinction, and what goes with each part of it.

Extinctions here are per reference length, so that they do not depend on the shell's thickness: divided by
`reference_length` they are per metre.
"""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from renderer.core.technique import Arrays
from renderer.shells.texture.block import CLAMP, ShellTexture, moment_arrays, opacity_then

MOST = np.float32(1 - CLAMP)
"""Opacity that counts as the greatest: see `CLAMP`."""


@dataclass(frozen=True)
class Extinct:
    """Matter in extinction form.

    Attributes:
        matter: (K, J, I, 4) float32, extinction times colour, and extinction, per reference length.
        surface: (K, J, I, 4) float32, extinction times mean normal, and times the share of glow.
    """

    matter: np.ndarray
    surface: np.ndarray


def extinct(baked: Arrays, *, growth: float = 1.0, density: float = 1.0, second: float = 1.0) -> Extinct:
    """A baked texture in extinction form, at a moment (see `texture_of`), in one pass."""
    colour = np.ascontiguousarray(baked["colour"], np.float32)
    normal = np.ascontiguousarray(baked["normal"], np.float32)
    found = Extinct(np.empty_like(colour), np.empty_like(normal))
    moment = moment_arrays(baked, growth, density, second)
    _extinct(colour, normal, baked["material"], *moment, found.matter, found.surface)
    return found


def form_of(texture: ShellTexture) -> Extinct:
    """The extinction form of a texture as it is drawn."""
    return extinct({"colour": texture.colour, "normal": texture.normal,
                    "material": np.broadcast_to(np.uint8(1), texture.colour.shape[:3])})


def halves(array: np.ndarray, factor: float = 1.0) -> np.ndarray:
    """An array of float32 times a factor as float16, rounded to the nearest: numpy's result in a fraction of its time.

    Args:
        array: any shape; times the factor within +-65504.
    """
    found = np.empty(array.shape, np.uint16)
    _halves(np.ascontiguousarray(array, np.float32).reshape(-1), np.float32(factor), found.reshape(-1))
    return found.view(np.float16)


def bytes_of(array: np.ndarray, signed: bool = False) -> np.ndarray:
    """An array of float32 as bytes, rounded up or down by chance that is the same each time: right in the mean.

    Args:
        array: (.., 4) in [0, 1]. signed: whether the first three are in [-1, 1] and stored as 128 + 127 x.
    """
    found = np.empty(array.shape, np.uint8)
    _bytes(np.ascontiguousarray(array, np.float32).reshape(-1), signed, found.reshape(-1))
    return found


@numba.njit(cache=True, nogil=True)
def _bytes(values, signed, found):
    for n in range(len(values)):
        # The low bits of a product with the golden ratio's run through all remainders evenly (Weyl 1916).
        chance = np.float32(np.uint32(np.uint32(n) * np.uint32(2654435769)) >> np.uint32(8)) * np.float32(2.0**-24)
        value = values[n] * np.float32(255)
        if signed and n % 4 != 3:
            value = np.float32(128) + values[n] * np.float32(127)
        whole = np.floor(value + chance)
        found[n] = np.uint8(min(max(whole, np.float32(0)), np.float32(255)))


@numba.njit(cache=True, nogil=True)
def _halves(values, factor, found):
    # IEEE 754 binary16, to the nearest and to the even one of two; below 2^-14 its numbers are multiples of 2^-24.
    for n in range(len(values)):
        value = np.float32(values[n] * factor)
        bits = np.float32(value).view(np.uint32)
        size = bits & np.uint32(0x7FFFFFFF)
        if size >= np.uint32(0x38800000):
            short = (size - np.uint32(0x38000000) + np.uint32(0xFFF) + ((size >> np.uint32(13)) & np.uint32(1))) >> 13
        elif size > 0:
            short = np.uint32(np.rint(abs(value) * np.float32(2.0**24)))
        else:
            short = size
        found[n] = ((bits >> np.uint32(16)) & np.uint32(0x8000)) | short


@numba.njit(cache=True, nogil=True, fastmath=True)
def _extinct(colour, normal, material, birth, rank, moment, matter, surface):
    growth, density, second = moment
    layers, rows, columns = material.shape
    for k in range(layers):
        for j in range(rows):
            for i in range(columns):
                opacity = opacity_then(
                    colour[k, j, i, 3], material[k, j, i], birth[k, j, i], rank[k, j, i], growth, density, second
                )
                sigma = np.float32(0)
                if opacity > 0:
                    sigma = -np.log1p(-min(opacity, MOST))
                for n in range(3):
                    matter[k, j, i, n] = sigma * colour[k, j, i, n]
                    surface[k, j, i, n] = sigma * normal[k, j, i, n]
                matter[k, j, i, 3] = sigma
                surface[k, j, i, 3] = sigma * normal[k, j, i, 3]
