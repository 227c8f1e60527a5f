"""Where the forest's techniques fail: the cases of its catalogue."""

from __future__ import annotations

from renderer.core.failure import Failure

PLAIN = {"height_shading.kind": "none", "filter.kind": "none"}
"""Nothing but the shadow differs from the reference: no empirical shading, no filter."""

FAILURES = (
    Failure(
        name="depth_map_scintillates",
        title="A shadow map scintillates while the sun moves",
        slot="shadow",
        failing="depth_shadow_map",
        surviving="double_horizon_map",
        preset="low_sun",
        symptom="flicker",
        sweep="sun_azimuth",
        sets=PLAIN,
        threshold=0.04,
        measured=(0.0922, 0.0054),
        cause="Each texel keeps one depth; when the sun turns, the texels slide over the crowns and meet other leaves.",
    ),
    Failure(
        name="perspective_map_vibrates",
        title="A perspective shadow map vibrates while the camera moves",
        slot="shadow",
        failing="perspective_shadow_map",
        surviving="cascaded_shadow_map:resolution=1024",
        preset="forest_edge",
        symptom="flicker",
        sweep="camera",
        sets=PLAIN,
        threshold=0.022,
        measured=(0.0269, 0.0182),
        cause="The map is drawn in the camera's own perspective, so each step turns every texel to another line.",
    ),
    Failure(
        name="perspective_map_errs_far_off",
        title="A perspective shadow map spends its texels near the eye",
        slot="shadow",
        failing="perspective_shadow_map",
        surviving="cascaded_shadow_map",
        preset="forest_edge",
        symptom="error",
        sets=PLAIN,
        threshold=0.11,
        measured=(0.1515, 0.0814),
        cause="After the camera's perspective far hills are a thin edge of the map: a texel there is tens of metres.",
    ),
    Failure(
        name="depth_map_shades_itself",
        title="A shadow map without a bias shades what it has drawn",
        slot="shadow",
        failing="depth_shadow_map:bias=0:texel_bias=0",
        surviving="depth_shadow_map",
        preset="noon",
        symptom="error",
        sets=PLAIN,
        threshold=0.45,
        measured=(0.662, 0.3125),
        cause="A texel's one depth is that of its middle; half of what it covers lies behind and counts as hidden.",
    ),
)
