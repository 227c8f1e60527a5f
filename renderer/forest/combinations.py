"""Named combinations of the forest's techniques: those of the thesis, and those of today."""

from __future__ import annotations

from typing import Any

from renderer.core.technique import Preset

THESIS_MAPS: dict[str, Any] = {"sectors": 4, "softness": 9.0, "strength": 1.0}
"""Cohen 2004, section 3.1 and listing 10.1: four sectors in one texel, a threshold of 0.1 right angles."""

EMPIRICAL: dict[str, Any] = {"kind": "empirical", "strength": 1.0, "foot": 0.5, "rise": 1.0}
"""Cohen 2004, section 3.2: C_h = 0.5 + h."""

NO_HEIGHT: dict[str, Any] = {"kind": "none"}

SEEN: dict[str, Any] = {"kind": "visible_hemisphere"}
"""At the finest level its sky light errs by 0.12 to 0.21, the pattern's own share by 0.21 to 0.40, for 0.1 yardstick.
At coarse levels it is too bright, so that filtered combinations keep the share."""

FINE: dict[str, Any] = {
    "geometry": {"kind": "ray_march", "step": 1.0, "stop": 0.02},
    "filter": {"kind": "none"},
}
"""What the eye's ray costs is paid when the camera moves, and kept while the sun does."""

COMBINATIONS = {
    "thesis_degraded": Preset(
        "Thesis, degraded",
        "One horizon map and Lambert light: what ran at 3 to 4 frames a second in 2004 (Cohen 2004, section 7.2).",
        {
            "shadow": {"kind": "horizon_map", **THESIS_MAPS},
            "height_shading": NO_HEIGHT,
            "light": {"kind": "lambert"},
        },
    ),
    "thesis_variant": Preset(
        "Thesis, two maps alone",
        "Double horizon maps up to 1.5 of the light, the low one at a right angle: no empirical term (section 3.2).",
        {
            "shadow": {"kind": "double_horizon_map", **THESIS_MAPS, "floor_low": 90.0, "bound": 1.5},
            "height_shading": NO_HEIGHT,
            "light": {"kind": "lambert"},
        },
    ),
    "thesis": Preset(
        "Thesis, complete",
        "Double horizon maps, empirical term and Lafortune lobes in one pass: the wish of chapter 7.",
        {
            "shadow": {"kind": "double_horizon_map", **THESIS_MAPS, "floor_low": 0.0, "bound": 1.0},
            "height_shading": EMPIRICAL,
            "light": {"kind": "lafortune"},
        },
    ),
    "soft_horizons": Preset(
        "Soft horizons",
        "Horizons that let light through, at many heights and azimuths, on thin leaves.",
        {"shadow": {"kind": "horizon_volume"}, "height_shading": NO_HEIGHT, "light": {"kind": "leaf"}},
    ),
    "traced": Preset(
        "Traced shadows",
        "The sun's ray is followed through the trees themselves, on thin leaves.",
        {"shadow": {"kind": "sun_march"}, "height_shading": NO_HEIGHT, "light": {"kind": "leaf"}},
    ),
    "traced_fine": Preset(
        "Traced shadows, fine",
        "The same, with finer steps of the eye's ray at the finest level: nearest to the reference.",
        {
            "shadow": {"kind": "sun_march", "step": 0.75},
            "height_shading": NO_HEIGHT,
            "light": {"kind": "leaf"},
            "sky": SEEN,
            **FINE,
        },
    ),
}
