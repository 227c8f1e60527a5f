"""What the clouds let be measured."""

from __future__ import annotations

from renderer.clouds.radiosity.quantity import RADIOSITY
from renderer.core.quantity import Quantity

QUANTITIES: dict[str, Quantity] = {"radiosity": RADIOSITY}
