"""Named views of the shells."""

from __future__ import annotations

from renderer.core.technique import Preset

PRESETS = {
    "fur": Preset("Fur", "Hair that grows on a sphere.", {}),
    "jelly": Preset(
        "Balls in jelly",
        "Opaque balls in red, semi-transparent matter.",
        {"texture": {"kind": "jelly"}, "base": {"opaque": True}, "surface": {"kind": "sphere"}},
    ),
}
