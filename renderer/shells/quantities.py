"""What the shells let be measured."""

from __future__ import annotations

from renderer.core.quantity import Quantity
from renderer.shells.measured_composite import COMPOSITE

QUANTITIES: dict[str, Quantity] = {"composite": COMPOSITE}
