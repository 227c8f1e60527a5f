"""What the shells let be measured."""

from __future__ import annotations

from renderer.core.quantity import Quantity
from renderer.shells.measured_composite import COMPOSITE
from renderer.shells.measured_shell import SHELL

QUANTITIES: dict[str, Quantity] = {"composite": COMPOSITE, "shell": SHELL}
