"""What the directional textures let be measured."""

from __future__ import annotations

from renderer.core.quantity import Quantity
from renderer.directional.measured_hemisphere import HEMISPHERE
from renderer.directional.measured_reflectance import REFLECTANCE

QUANTITIES: dict[str, Quantity] = {"hemisphere": HEMISPHERE, "reflectance": REFLECTANCE}
