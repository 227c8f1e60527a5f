"""The bake that turns shadow hemispheres into the words of one code, and which codes there are."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from renderer.core.technique import Arrays
from renderer.directional.codes.bits import Bits
from renderer.directional.codes.chosen import Chosen, learn_sets
from renderer.directional.codes.code import Code
from renderer.directional.codes.codebook import TAUGHT, Codebook, learn
from renderer.directional.codes.exact_harmonics import ExactHarmonics
from renderer.directional.codes.harmonics import Harmonics
from renderer.directional.codes.horizon_ring import HorizonRing
from renderer.directional.codes.spherical_harmonics import SphericalHarmonics, fitted
from renderer.directional.hemisphere import Hemisphere, hemisphere_of
from renderer.directional.shadow_hemispheres import unpacked

POINTS = 1 << 16
"""Coded at once."""


MAKERS: dict[str, Callable[[Hemisphere, int, np.ndarray], Code]] = {
    "bits": lambda layout, size, masks: Bits(layout),
    "chosen": lambda layout, size, masks: learn_sets(layout, masks),
    "codebook": learn,
    "exact_harmonics": lambda layout, size, masks: ExactHarmonics(layout),
    "harmonics": lambda layout, size, masks: Harmonics(layout, size),
    "horizon_ring": lambda layout, size, masks: HorizonRing(layout, size),
    "spherical_harmonics": fitted,
}
"""Codes by their technique's kind, for masks of a layout, so many bytes a point, and masks to learn of."""

CODE_SIZES = {
    "bits": (0,),
    "chosen": (9,),
    "codebook": (5, 9),
    "exact_harmonics": (0,),
    "harmonics": (5, 9, 17, 33),
    "horizon_ring": (5, 9, 17),
    "spherical_harmonics": (5, 9, 17, 33),
}
"""Bytes a point that each code may have; 0 where the mask leaves no choice."""


def bake_code(
    arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]
) -> dict[str, np.ndarray]:
    """Words of every used point.

    Args:
        arguments: kind of the technique, directions, and, where its code leaves a choice, size [bytes].
        inputs: shadows, as `bake_shadows` gives them.

    Returns:
        `words` (M, W) uint32, and the tables of codes that have any.
    """
    layout, bits = hemisphere_of(arguments["directions"]), inputs["shadows"]["bits"]
    progress(0.0, "learning shadow hemispheres")
    taught = unpacked(bits[:: -(-len(bits) // TAUGHT)], layout.count)
    code = MAKERS[arguments["kind"]](layout, arguments.get("size", 0), taught)
    parts = []
    for start in range(0, len(bits), POINTS):
        progress(start / len(bits), "coding shadow hemispheres")
        parts.append(code.encode(unpacked(bits[start : start + POINTS], layout.count)))
    tables = code.tables() if isinstance(code, Codebook | Chosen | SphericalHarmonics) else {}
    return {"words": np.concatenate(parts), **tables}
