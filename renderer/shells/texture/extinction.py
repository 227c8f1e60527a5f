"""The form in which matter is filtered and interpolated: extinction, and what goes with each part of it.

Extinctions here are per reference length, so that they do not depend on the shell's thickness: divided by
`reference_length` they are per metre.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numba
import numpy as np

from renderer.core.technique import Arrays
from renderer.shells.texture.block import CLAMP, SOFT_TIP

LEAST = float(CLAMP)


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
    strands = "birth" in baked
    nothing = np.zeros((1, 1, 1), np.float32)
    colour = np.ascontiguousarray(baked["colour"], np.float32)
    normal = np.ascontiguousarray(baked["normal"], np.float32)
    birth, rank = (np.asarray(baked[name], np.float32) if strands else nothing for name in ("birth", "rank"))
    found = Extinct(np.empty_like(colour), np.empty_like(normal))
    moment = np.array([growth, density, second], np.float32)
    _extinct(colour, normal, baked["material"], birth, rank, moment, strands, found.matter, found.surface)
    return found


@numba.njit(cache=True, nogil=True, fastmath=True)
def _extinct(colour, normal, material, birth, rank, moment, strands, matter, surface):
    growth, density, second = moment
    layers, rows, columns = material.shape
    for k in range(layers):
        for j in range(rows):
            for i in range(columns):
                opacity = colour[k, j, i, 3]
                if opacity > 0 and material[k, j, i] == 2:
                    opacity *= second
                if opacity > 0 and strands:
                    if rank[k, j, i] >= density:
                        opacity = np.float32(0)
                    else:
                        grown = (growth - birth[k, j, i]) / SOFT_TIP
                        opacity *= min(max(grown, np.float32(0)), np.float32(1))
                sigma = np.float32(0)
                if opacity > 0:
                    sigma = np.float32(-math.log1p(-min(np.float64(opacity), 1.0 - LEAST)))
                for n in range(3):
                    matter[k, j, i, n] = sigma * colour[k, j, i, n]
                    surface[k, j, i, n] = sigma * normal[k, j, i, n]
                matter[k, j, i, 3] = sigma
                surface[k, j, i, 3] = sigma * normal[k, j, i, 3]
