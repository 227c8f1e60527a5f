"""Where techniques of the directional textures fail, why, and what survives there.

Measured at 48 pixels with 60,000 points in a light without shadows, but for those that have a chart.
"""

from __future__ import annotations

from typing import Any

from renderer.core.failure import ChartedFailure, Failure

_PLAIN: dict[str, Any] = {
    "cloud.points": 60_000,
    "visibility.texels": 64,
    "visibility.directions": 129,
    "hemispheres.directions": 33,
    "self_shadow": {"kind": "none"},
    "light": {"kind": "phong", "ambient": 0.0, "specular": 0.0},
    "view.background": "none",
    "camera": {"kind": "orbit", "target": [0, 0, 0.5], "distance": 3.4, "azimuth": 150, "elevation": 18,
               "field_of_view": 30},
    # behind the eye, so that no shadow is seen
    "sun": {"kind": "direction", "azimuth": 150, "elevation": 18},
}

_MEASURES = "renderer.directional.failure_measures"

FAILURES = (
    Failure(
        name="popping",
        title="The nearest direction leaps as one walks round",
        slot="selection",
        failing="nearest",
        surviving="position_corrected",
        preset="knot",
        sets=_PLAIN,
        symptom="flicker",
        sweep="camera.azimuth",
        threshold=0.35,
        measured=(0.612, 0.166),
        cause="Each texel shows what is seen from the middle of a cell of directions, and changes at once at its edge.",
    ),
    Failure(
        name="ghosting",
        title="Directions laid over each other show everything four times",
        slot="selection",
        failing="blended",
        surviving="position_corrected",
        preset="knot",
        sets={**_PLAIN, "visibility.directions": 513},
        symptom="error",
        threshold=0.35,
        measured=(0.469, 0.254),
        cause="What lies deep in the box moves from texel to texel with the direction, and a mixture shows all places.",
    ),
    ChartedFailure(
        name="thin_parts",
        title="Thin parts fall between the texels",
        failing="16 texels",
        surviving="128 texels",
        symptom="share of a fence with bars of 6 cm that stands in texels whose own ray goes by",
        threshold=0.15,
        measured=(0.285, 0.0493),
        cause="A texel has one ray for each direction, and what does not meet it is not there.",
        measure=f"{_MEASURES}:thin_parts",
    ),
    ChartedFailure(
        name="inside_the_box",
        title="A camera inside the box sees nothing",
        failing="from within the box",
        surviving="from outside of it",
        symptom="share of what should be seen that no face of the box is looked through for",
        threshold=0.5,
        measured=(1.0, 0.0),
        cause="Faces know what is seen from outside through them; an eye within the box has all of them behind it.",
        measure=f"{_MEASURES}:inside_the_box",
    ),
    ChartedFailure(
        name="grazing_light",
        title="Light low over the horizon is misjudged",
        failing="129 directions, the nearest",
        surviving="513 directions, the nearest",
        symptom="share of a knot's points that are lit or dark wrongly by light 2 to 10 degrees above their horizons",
        threshold=0.12,
        measured=(0.149, 0.0865),
        cause="Near the horizon shadows end within a cell of eleven degrees, which is lit or dark as a whole.",
        measure=f"{_MEASURES}:grazing_light",
    ),
    ChartedFailure(
        name="ringing",
        title="A few harmonics leave the range from dark to lit",
        failing="harmonics, nine bytes",
        surviving="horizon ring, nine bytes",
        symptom="share of a knot's hemispheres that is below 0 or above 1 by more than a tenth, before it is clamped",
        threshold=0.03,
        measured=(0.0735, 0.0),
        cause="Cut off, a series of waves swings over both sides of every edge that it is made of.",
        measure=f"{_MEASURES}:ringing_harmonics",
    ),
    ChartedFailure(
        name="open_mesh",
        title="The back of an open mesh is lit as if from inside",
        failing="one-sided",
        surviving="two-sided",
        symptom="share of what the faces see of a bowl whose normals look away from the eye by more than 110 degrees",
        threshold=0.05,
        measured=(0.298, 0.0),
        cause="A point has one normal, and where a mesh is open its wrong side is seen, too.",
        measure=f"{_MEASURES}:open_mesh",
    ),
)
