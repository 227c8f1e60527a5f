"""The bake that turns shadow hemispheres into the words of one code, and which codes there are."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from renderer.core.technique import Arrays
from renderer.directional.codes.bits import Bits
from renderer.directional.codes.code import Code
from renderer.directional.codes.harmonics import Harmonics
from renderer.directional.hemisphere import Hemisphere, hemisphere_of
from renderer.directional.shadow_hemispheres import unpacked

POINTS = 1 << 16
"""Coded at once."""


def code_of(name: str, layout: Hemisphere, size: int) -> Code:
    """A code by its technique's kind, for masks of a layout and so many bytes a point."""
    makers: dict[str, Callable[[], Code]] = {
        "bits": lambda: Bits(layout),
        "harmonics": lambda: Harmonics(layout, size),
    }
    return makers[name]()


def bake_code(
    arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]
) -> dict[str, np.ndarray]:
    """Words of every used point.

    Args:
        arguments: code (a technique's kind), size [bytes], directions.
        inputs: shadows, as `bake_shadows` gives them.

    Returns:
        `words` (M, W) uint32.
    """
    layout = hemisphere_of(arguments["directions"])
    code = code_of(arguments["code"], layout, arguments["size"])
    bits = inputs["shadows"]["bits"]
    parts = [code.encode(unpacked(bits[:1], layout.count))[:0]]
    for start in range(0, len(bits), POINTS):
        progress(start / len(bits), "coding shadow hemispheres")
        parts.append(code.encode(unpacked(bits[start : start + POINTS], layout.count)))
    return {"words": np.concatenate(parts)}
