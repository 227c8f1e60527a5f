"""What the clouds let be measured."""

from __future__ import annotations

from renderer.clouds.measured_droplets import MIE
from renderer.clouds.measured_slab import SLAB
from renderer.clouds.radiosity.quantity import RADIOSITY
from renderer.core.quantity import Quantity

QUANTITIES: dict[str, Quantity] = {"mie": MIE, "radiosity": RADIOSITY, "slab": SLAB}
