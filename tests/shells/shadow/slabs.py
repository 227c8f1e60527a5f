"""An even slab in the sun, whose light has a closed form."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from renderer.core.baking import bake_now
from renderer.core.cache import Cache
from renderer.core.params import validate
from renderer.shells.bakes import sky_bake
from renderer.shells.state import ShellsState
from renderer.world.sky import sky_for
from tests.shells.conftest import even

Draw = Callable[..., np.ndarray]
THICKNESS = 0.5


def lit(draw: Draw, shadow: dict[str, Any], depth: float, elevation: float = 90.0, size: int = 8) -> float:
    """Mean radiance in the middle of a slab of an optical depth, seen from above."""
    sun = {"kind": "direction", "azimuth": 90.0, "elevation": elevation}
    patch = {"light": {"kind": "lambert"}, "sun": sun, "shadow": shadow}
    block = even(1 - np.exp(-depth * 0.1 / THICKNESS), layers=16)
    found = draw(patch, block, size=size)
    middle = slice(size // 2 - 1, size // 2 + 1)
    return float(found[middle, middle, 1].mean())


def share(depth: float, elevation: float) -> float:
    """Light scattered once, of what all of the sun would give: in a slab seen from above, by closed form.

    Sun and eye alike pass what lies above: the integral of sigma exp(-sigma z (1 + 1 / sin e)) dz, over that of the eye
    alone.
    """
    slant = 1 + 1 / np.sin(np.radians(elevation))
    return float((1 - np.exp(-depth * slant)) / slant / (1 - np.exp(-depth)))


def sun_share(draw: Draw, shadow: dict[str, Any], depth: float, elevation: float) -> float:
    """The sun's light in the slab, against what there would be without shadow; the sky's is taken off both."""
    tables = bake_now(sky_bake(validate(ShellsState, {"scene": "shells"})), Cache())
    sky = 0.5 * float(sky_for(tables, np.radians(elevation)).sky_irradiance[1]) / np.pi * (1 - np.exp(-depth))
    bright = lit(draw, {"kind": "none"}, depth, elevation)
    return (lit(draw, shadow, depth, elevation) - sky) / (bright - sky)
