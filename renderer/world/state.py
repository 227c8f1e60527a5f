"""What every scene's state document holds: version, scene, camera, sun, quality, view and time.

One JSON document, the same at every door: what the page shares in its address, REST renders.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import Field

from renderer.core.errors import InputError
from renderer.core.params import Model, param
from renderer.world.camera import Camera, Orbit
from renderer.world.sun import Sun, SunDirection

VERSION = 2
"""Version of the document that this code writes."""

NOON = 1000.0
"""Light to which a fixed exposure is set, in W m-2: about that of a clear noon."""

DARKEST = 0.5
"""Least light to which the exposure adapts, in W m-2: that of civil twilight. Below it the picture darkens."""

CONVERGED_SAMPLES = 64
"""Samples a pixel after which a picture counts as converged: an 8 x 8 grid of sub-pixel positions."""

ToneCurve = Literal["filmic", "linear"]
Background = Literal["sky", "none", "white"]


class Draft(Model):
    """One sample a pixel."""

    kind: Literal["draft"] = "draft"


class Samples(Model):
    """A chosen number of samples a pixel: identical pixels at every door."""

    kind: Literal["samples"] = "samples"
    n: int = param(16, label="Samples", help="Samples a pixel.", unit="count", cost="host", ge=1, le=4096)


class Converged(Model):
    """As many samples as a still picture needs."""

    kind: Literal["converged"] = "converged"


Quality = Annotated[Draft | Samples | Converged, Field(discriminator="kind")]


def samples_of(quality: Draft | Samples | Converged) -> int:
    """Samples a pixel that a quality asks for."""
    if isinstance(quality, Samples):
        return quality.n
    return 1 if isinstance(quality, Draft) else CONVERGED_SAMPLES


class View(Model):
    """How linear radiance becomes a picture."""

    auto_exposure: bool = param(
        True,
        label="Follow the light",
        help="Exposure follows the light of sun and sky; otherwise it stays at that of a clear noon.",
        cost="host",
    )
    exposure: float = param(
        1.0,
        label="Exposure",
        help="Stops above the exposure that shows an 18 % grey as it is; woods and meadows are about one darker.",
        unit="EV",
        cost="host",
        ge=-16,
        le=16,
        step=0.1,
    )
    tone_curve: ToneCurve = param(
        "filmic",
        label="Tone curve",
        help="Curve that fits radiance to the screen.",
        cost="host",
        source="Narkowicz 2015, ACES filmic tone mapping curve",
    )
    background: Background = param("sky", label="Background", help="What shows behind the scene.", cost="host")


class SceneState(Model):
    """Base of every scene's whole state. A subclass narrows `scene` to its own name and adds its slots."""

    version: Literal[2] = param(VERSION, label="Version", help="Version of the document.", cost="host")
    scene: str = param("", label="Scene", help="Name of the scene.", cost="host", max_length=64)
    camera: Camera = param(Orbit(), label="Camera", help="Where the picture is taken from.", cost="host")
    sun: Sun = param(SunDirection(), label="Sun", help="Where the light comes from.", cost="host")
    quality: Quality = param(Converged(), label="Quality", help="How much work a still picture is worth.", cost="host")
    view: View = param(View(), label="View", help="Exposure, tone curve and background.", cost="host")
    time: float = param(0.0, label="Time", help="Time of what moves by itself.", unit="s", cost="host", ge=0, le=1e9)


def exposure_ev(view: View, light: float) -> float:
    """Stops by which radiance in W m-2 sr-1 is brightened for display.

    A matt, level 18 % grey sends 0.18 light / pi, and log2(pi / light) shows it as 0.18 of the screen's light by
    the linear curve: so an incident light meter sets a camera. `view.exposure` comes on top. All depends on the state
    and nothing on the picture, so that every door shows the same, and nothing flickers.

    Args:
        view: of a state.
        light: of sun and sky, in W m-2, as the scene's `metered_light` says.
    """
    metered = max(light, DARKEST) if view.auto_exposure else NOON
    return math.log2(math.pi / metered) + view.exposure


def migrate(document: Any) -> dict[str, Any]:
    """A document of any older version, as this version writes it; one without a version is of this one.

    Raises:
        InputError: no JSON object, a version that is no whole number, or one that this code does not know yet.
    """
    if not isinstance(document, dict):
        raise InputError("", "the state must be a JSON object")
    version = document.get("version", VERSION)
    if isinstance(version, bool) or not isinstance(version, int):
        raise InputError("version", "must be a whole number", f"1 to {VERSION}")
    if not 1 <= version <= VERSION:
        raise InputError("version", "this server does not know documents of this version", f"1 to {VERSION}")
    if version == 1:
        document = {**document, "view": _view_of_first(document.get("view", {}))}
    return {**document, "version": VERSION}


def _view_of_first(view: Any) -> Any:
    """The view of a document of version 1, whose exposure was fixed and counted from 1 W m-2 sr-1, -6.5 by default."""
    old = view.get("exposure", -6.5) if isinstance(view, dict) else None
    if isinstance(old, bool) or not isinstance(old, (int, float)) or not -24 <= old <= 24:
        return view  # refused by its name, like any other wrong value
    return {**view, "auto_exposure": False, "exposure": min(old + math.log2(NOON / math.pi), 16.0)}
