"""Named views of the directional textures."""

from __future__ import annotations

from renderer.core.technique import Preset

PRESETS = {
    "knot": Preset(
        "Knot",
        "A rope of three strands, knotted: it hides much of itself from the sun.",
        {"selection": {"kind": "position_corrected"}},
    ),
}
