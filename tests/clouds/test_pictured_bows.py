"""Fogbow and glory in the picture itself: rings round the shadow's point of a thick, even layer, the sun overhead."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from renderer.clouds.bows import Bows, bows
from renderer.clouds.phase.mie import Mie
from renderer.clouds.phase_tables import SUN_RADIUS
from renderer.core.technique import Arrays, Bake
from renderer.session import Session

OVER_THE_LAYER: dict[str, Any] = {
    "sun": {"kind": "direction", "azimuth": 0, "elevation": 90},
    "clouds": {"kind": "uniform"},
    "land": {"kind": "flat"},
    "layer.thickness": 2000,
    "air.haze": 0.0,
    "scattering.kind": "single",
    "bounce.kind": "none",
    "planet.albedo": [0, 0, 0],
    "planet.site_size": 1e6,
    "quality": {"kind": "samples", "n": 2},
}
GLORY_VIEW, BOW_VIEW = 12.0, 96.0
"""Fields of view, degrees."""


@pytest.fixture(scope="module")
def session() -> Iterator[Session]:
    with Session() as opened:
        yield opened


@pytest.fixture(scope="module")
def known(baked: Callable[[Bake], Arrays]) -> list[Bows]:
    """Where the droplets put them, in each band."""
    moments = baked(Mie().phase_bake())["moments"]
    return [bows(moments[band], SUN_RADIUS) for band in range(3)]


def rings(session: Session, view: float, size: int, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Mean radiance by the angle from the point opposite the sun: degrees (N,), and (N, 3)."""
    camera = {"kind": "look", "eye": [0, 0, 5000], "target": [0, 0, 0], "up": [0, 1, 0], "field_of_view": view}
    light = session.render(session.state("clouds", None, {**OVER_THE_LAYER, "camera": camera}), size, size).linear
    focal = size / 2 / np.tan(np.radians(view / 2))
    y, x = np.mgrid[:size, :size] + 0.5 - size / 2
    away = np.degrees(np.arctan(np.hypot(x, y) / focal))
    place = (away / step).astype(int)
    counts = np.bincount(place.ravel())
    filled = counts > 0
    angles = np.bincount(place.ravel(), away.ravel())[filled] / counts[filled]
    bands = [np.bincount(place.ravel(), light[..., band].ravel())[filled] / counts[filled] for band in range(3)]
    return angles, np.stack(bands, axis=-1)


def off_the_rings(session: Session, known: list[Bows]) -> float:
    """How far the glory's three inner rings lie from where they should, at most, degrees."""
    angles, light = rings(session, GLORY_VIEW, 480, 0.04)
    worst = 0.0
    for band in range(3):
        for ring in np.degrees(known[band].glory[:3]):
            beside = np.abs(angles - ring) < 0.4
            worst = max(worst, abs(angles[beside][np.argmax(light[beside, band])] - ring))
    return worst


def test_the_glory_s_rings(session: Session, known: list[Bows]) -> None:
    assert off_the_rings(session, known) < 0.1


def test_the_fogbow(session: Session, known: list[Bows]) -> None:
    angles, light = rings(session, BOW_VIEW, 384, 0.25)
    beside = (angles > 34) & (angles < 43)
    for band in range(3):
        found = angles[beside][np.argmax(light[beside, band])]
        assert abs(found - np.degrees(known[band].fogbow)) < 0.25 + 0.125, "and half a ring of the mean"


def test_half_the_angle_is_found(session: Session, known: list[Bows], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(OVER_THE_LAYER, "phase", {"kind": "mie", "radius": 5.0})  # rings scale as 1 / radius
    assert off_the_rings(session, known) > 0.2
