"""What level ground errs by for the light of the clouds over a sunlit ridge (Belcour 2009, section 5.1.3)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from renderer.clouds.radiosity.bases import HALF
from renderer.clouds.radiosity.scenes import GROUND
from renderer.radiosity_study import FINE
from renderer.reference.cloud_radiosity_rays import cast, gather

Tell = Callable[[float, str], None]


@dataclass(frozen=True)
class Ridge:
    """A ridge of gable section that runs north to south, and the sun in the east (Belcour 2009, figure 5.4).

    Attributes:
        half_width: in heights. slope, sun: degrees.
    """

    half_width: float
    slope: float
    sun: float


def ridge_error(ridge: Ridge, rays: int = 256) -> float:
    """Mean error of level ground for the base's light over a sunlit ridge, first half-bounce (figure 5.5)."""
    corners = np.linspace(-HALF, HALF, FINE + 1)
    rise, climb = np.tan(np.radians(ridge.slope)), np.tan(np.radians(ridge.sun))
    gable = np.maximum(0.0, ridge.half_width - np.abs(corners)) * rise
    if gable.max() >= 0.95:
        return float("nan")
    middles = (corners[1:] + corners[:-1]) / 2
    slopes = np.diff(gable) / np.diff(corners)
    facing = np.maximum(np.sin(np.radians(ridge.sun)) - slopes * np.cos(np.radians(ridge.sun)), 0)
    facing /= np.sqrt(1 + slopes**2)
    # Where the ridge's crest stands before the sun, the ground lies in its shadow.
    high = (gable[1:] + gable[:-1]) / 2
    crest = ridge.half_width * rise - climb * (0.0 - middles)
    facing = np.where((middles < 0) & (high < crest - 1e-9) & (climb < rise), 0.0, facing)
    light = GROUND * np.broadcast_to(facing, (FINE, FINE))
    turns = np.random.default_rng(1).random((2, FINE, FINE, 2))
    hits = cast(np.broadcast_to(gable, (FINE + 1, FINE + 1)).copy(), HALF, rays, turns)
    dark = np.zeros(FINE * FINE + 1)
    relief = gather(hits, np.concatenate([light.ravel(), dark]))[1]
    even = np.full((FINE, FINE), GROUND * np.sin(np.radians(ridge.sun)))
    level = gather(cast(np.zeros((FINE + 1, FINE + 1)), HALF, rays, turns), np.concatenate([even.ravel(), dark]))[1]
    over = (np.abs(middles) < max(ridge.half_width, 0.5))[None, :] & (np.abs(middles) < 8)[:, None]
    return float(np.mean(np.abs(level - relief)[over]) / np.mean(relief[over]))


def ridge_lines(rays: int, tell: Tell) -> list[dict[str, Any]]:
    """The error over slopes, widths and suns."""
    wanted = [Ridge(1.0, slope, sun) for slope in (10.0, 20.0, 30.0, 40.0) for sun in (5, 10, 15, 20, 30, 45, 60, 90)]
    wanted += [Ridge(width, 25.0, sun) for width in (0.5, 1.0, 1.5, 2.0) for sun in (5, 10, 15, 20, 30, 45, 60, 90)]
    lines = []
    for k, ridge in enumerate(wanted):
        tell(k / len(wanted), "ridges under the sun")
        lines.append({**vars(ridge), "error": ridge_error(ridge, rays)})
    return lines
