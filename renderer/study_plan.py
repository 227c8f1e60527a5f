"""What a study covers: views, suns, and the slots whose techniques are combined."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from renderer.benching import COMBINATION
from renderer.core.errors import InputError
from renderer.core.registry import phenomenon, techniques
from renderer.truth import Judge
from renderer.world.state import View

JUDGED: dict[Judge, str] = {"combination": "", "shadow": "shadow"}
"""Folder of each judgement's results inside a study's."""

SHADOWED = frozenset({"forest"})
"""Scenes whose reference can be had under the picture's own light."""

SUNS: Mapping[str, tuple[float, float]] = {
    "az180_el62": (180.0, 62.0),
    "az120_el20": (120.0, 20.0),
    "az090_el08": (90.0, 8.0),
    "az150_el40": (150.0, 40.0),
    "az210_el50": (210.0, 50.0),
    "az240_el30": (240.0, 30.0),
    "az270_el15": (270.0, 15.0),
    "az300_el05": (300.0, 5.0),
    "az180_el80": (180.0, 80.0),
    "az060_el10": (60.0, 10.0),
    "az135_el75": (135.0, 75.0),
    "az225_el70": (225.0, 70.0),
    "az105_el55": (105.0, 55.0),
    "az255_el45": (255.0, 45.0),
    "az195_el35": (195.0, 35.0),
    "az165_el25": (165.0, 25.0),
    "az075_el30": (75.0, 30.0),
    "az285_el12": (285.0, 12.0),
    "az320_el18": (320.0, 18.0),
    "az040_el07": (40.0, 7.0),
    "az000_el65": (0.0, 65.0),
    "az330_el45": (330.0, 45.0),
    "az030_el22": (30.0, 22.0),
    "az345_el09": (345.0, 9.0),
}
"""Azimuth and elevation of the study's suns, degrees: from all sides, from near the horizon to the summer noon of the
tropics. The first few alone already differ as much as they can."""

SOME_SUNS = 8
"""Suns of a study of slots, whose techniques are combined with each other; a study of combinations takes all."""

SLOTS = ("shadow", "light", "geometry")
"""Slots whose techniques are combined, as far as a scene has them, where none are named; the others keep their
defaults."""

EXACT = "exact"
"""Stands for a slot's technique in a picture that the reference drew."""


@dataclass(frozen=True)
class Plan:
    """What a study covers.

    Attributes:
        scene: its name.
        presets, suns, slots: by name; the one slot `combination` stands for the scene's named combinations.
        size: side of the pictures, pixels.
        judge: what the pictures are judged for.
    """

    scene: str
    presets: tuple[str, ...] = ()
    suns: tuple[str, ...] = tuple(SUNS)[:SOME_SUNS]
    slots: tuple[str, ...] = ()
    size: int = 128
    judge: Judge = "combination"

    def checked(self) -> Plan:
        """The plan with its presets named.

        Raises:
            InputError: naming the option.
        """
        found = phenomenon(self.scene)
        presets = self.presets or tuple(found.presets)[:1]
        slots = self.slots or tuple(name for name in SLOTS if name in self.slots_of(self.scene))
        known = {"presets": tuple(found.presets), "suns": tuple(SUNS), "slots": self.slots_of(self.scene)}
        for option, given in (("presets", presets), ("suns", self.suns), ("slots", slots)):
            for name in given:
                if name not in known[option]:
                    raise InputError(option, f"there is no {name} in {self.scene}", ", ".join(known[option]))
        if COMBINATION in self.slots and len(self.slots) > 1:
            raise InputError("slots", f"{COMBINATION} fills all of them", "alone, or the slots by name")
        if not 16 <= self.size <= 256:
            raise InputError("size", f"{self.size} px are not studied", "16 to 256: the reference runs on the CPU")
        return replace(self, presets=presets, slots=slots)

    @staticmethod
    def slots_of(scene: str) -> tuple[str, ...]:
        """What a study of a scene may combine."""
        found = phenomenon(scene)
        return (*(slot.name for slot in found.slots), *([COMBINATION] if found.combinations else []))

    @property
    def judged(self) -> Mapping[Judge, str]:
        """Folder of each judgement's results inside the study's."""
        if self.slots == (COMBINATION,):
            return {"combination": COMBINATION}
        return JUDGED if self.scene in SHADOWED else {"combination": ""}


def kinds_of(scene: str, slot: str) -> Iterable[str]:
    """What may fill a slot, or the names of the combinations."""
    return phenomenon(scene).combinations if slot == COMBINATION else techniques(scene, slot)


def light_of(name: str) -> dict[str, Any]:
    """What a sun of the study sets: the sun as a document, and the exposure, of which a preset may have its own."""
    azimuth, elevation = SUNS[name]
    return {"sun": {"kind": "direction", "azimuth": azimuth, "elevation": elevation}, "exposure": View().exposure}
