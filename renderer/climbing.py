"""The climb from two metres over a valley to space, in one move: pictures on the way, and where the picture leaps.

Beside the pictures, the sight is stepped over each height at which the renderer changes how it draws, by a part in ten
thousand on either side: what changes there is a leap that the eye would see in a move without end.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from PIL import Image, ImageDraw

from renderer.clouds.bakes import land_bake
from renderer.clouds.world_scale import AIR_TOP, LAND_CELL, PLANET_RADIUS
from renderer.session import Session

LOWEST, HIGHEST = 2.0, 2.0e7
"""Heights over the ground where the climb begins and ends, m."""

PLACE = (5525.0, 3325.0)
"""East and north of the site, m: in a valley of the land."""

TURNS_DOWN = (3.0e4, 8.0e6)
"""Heights between which the sight sinks from the horizon to the middle of the Earth, m."""

LOOKS_DOWN = (5.0e2, 5.0e4)
"""Heights between which it goes from above the horizon to below it, m."""

AZIMUTH, FIELD_OF_VIEW = 20.0, 55.0
STEP = 1e-4
"""Part of its height by which the camera is stepped over a seam, either way."""

SIZE, SAMPLES = (288, 192), 4
COLUMNS = 6

Tell = Callable[[float, str], None]


@dataclass(frozen=True)
class Seam:
    """What changes where the renderer draws in another way.

    Attributes:
        name: of the height. height: m over the sphere. leap: RMS of the change over the picture's mean, across it.
        step: the same for a step of that length beside it.
    """

    name: str
    height: float
    leap: float
    step: float


def heights(count: int) -> list[float]:
    """Heights over the ground, m, each the same part higher than the one before."""
    return [float(h) for h in np.geomspace(LOWEST, HIGHEST, count)]


def camera(height: float, ground: float = 0.0) -> dict[str, Any]:
    """The camera so high over the ground at `PLACE`, which lies `ground` m above the sphere."""
    up = height + ground
    dip = math.acos(PLANET_RADIUS / (PLANET_RADIUS + up))
    down = dip + math.radians(-6.0 + 12.0 * _between(height, LOOKS_DOWN)) * (1 - _between(height, TURNS_DOWN))
    down += (math.pi / 2 - dip) * _between(height, TURNS_DOWN)
    azimuth = math.radians(AZIMUTH)
    east, north = PLACE
    # Straight up at the place, on the sphere.
    radius = PLANET_RADIUS + up
    outward = np.array([east, north, PLANET_RADIUS]) / math.hypot(east, north, PLANET_RADIUS)
    eye = radius * outward - (0.0, 0.0, PLANET_RADIUS)
    ahead = np.array([math.sin(azimuth), math.cos(azimuth), 0.0])
    ahead -= outward * (ahead @ outward)
    ahead /= np.linalg.norm(ahead)
    sight = math.cos(down) * ahead - math.sin(down) * outward
    above = math.sin(down) * ahead + math.cos(down) * outward
    target = eye + max(1.0e3, height) * sight
    vector = {name: [float(v) for v in point] for name, point in (("eye", eye), ("target", target), ("up", above))}
    return {"kind": "look", **vector, "field_of_view": FIELD_OF_VIEW}


def _between(height: float, ends: tuple[float, float]) -> float:
    """How far a height is between two, by their logarithms, in [0, 1], smooth at both."""
    low, high = (math.log(h) for h in ends)
    t = min(max((math.log(height) - low) / (high - low), 0.0), 1.0)
    return t * t * (3 - 2 * t)


def ground_at_place(session: Session, state: Any) -> float:
    """Height of the land at `PLACE` over the sphere, m: the highest of the nodes around it."""
    height = session.compute(land_bake(state))["height"]
    row, column = (int(v / LAND_CELL + len(height) / 2) for v in (PLACE[1], PLACE[0]))
    return float(height[row - 1 : row + 2, column - 1 : column + 2].max())


def climb(session: Session, document: dict[str, Any], count: int, tell: Tell) -> Image.Image:
    """A contact sheet of `count` pictures, read along its rows.

    Args:
        document: state of the clouds, whose camera and quality do not matter.
    """
    base = session.validate(document)
    ground = ground_at_place(session, base)
    pictures = []
    for number, height in enumerate(heights(count)):
        tell(number / count, f"{_words(height)} up")
        pictures.append(_drawn(session, document, camera(height, ground), SIZE, SAMPLES).rgb8)
    return sheet(pictures, [_words(height) for height in heights(count)])


def seams(session: Session, document: dict[str, Any], tell: Tell, size: tuple[int, int] = (96, 64)) -> list[Seam]:
    """What leaps at the heights at which drawing changes, against a step of the same length beside each."""
    state: Any = session.validate(document)
    ground = ground_at_place(session, state)
    layer = state.layer
    named = (
        ("base of the layer", layer.base),
        ("its middle", layer.base + 0.5 * layer.thickness),
        ("its mean top", layer.base + layer.thickness),
        ("twice its thickness", layer.base + 2.0 * layer.thickness),
        ("the air's points spread otherwise", 6000.0),
        ("sun may have set below", 0.5 * AIR_TOP),
        ("top of the air", AIR_TOP),
    )
    found = []
    for number, (name, height) in enumerate(named):
        tell(number / len(named), name)
        at = [height * (1 + STEP * part) for part in (-3, -1, 1)]
        shots = [_drawn(session, document, camera(h - ground, ground), size, 4).linear[..., :3] for h in at]
        mean = float(np.mean(shots))
        leap, step = (
            float(np.sqrt(np.mean((a - b) ** 2)) / mean) for a, b in ((shots[2], shots[1]), (shots[1], shots[0]))
        )
        found.append(Seam(name, height, leap, step))
    return found


def table(found: list[Seam]) -> str:
    """The seams as a table of Markdown."""
    head = ["| height | what changes there | leap | the step before |", "| ---: | --- | ---: | ---: |"]
    return "\n".join(head + [f"| {_words(s.height)} | {s.name} | {s.leap:.5f} | {s.step:.5f} |" for s in found]) + "\n"


def sheet(pictures: list[np.ndarray], labels: list[str]) -> Image.Image:
    """Pictures of one size (H, W, 3) in rows, each with its label."""
    height, width = pictures[0].shape[:2]
    rows = -(-len(pictures) // COLUMNS)
    found = Image.new("RGB", (COLUMNS * width, rows * height))
    draw = ImageDraw.Draw(found)
    for number, (picture, label) in enumerate(zip(pictures, labels, strict=True)):
        x, y = number % COLUMNS * width, number // COLUMNS * height
        found.paste(Image.fromarray(picture), (x, y))
        draw.text((x + 7, y + 6), label, fill=(0, 0, 0))
        draw.text((x + 6, y + 5), label, fill=(255, 255, 255))
    return found


def _drawn(session: Session, document: dict[str, Any], view: dict[str, Any], size: tuple[int, int], n: int) -> Any:
    state = session.validate({**document, "camera": view, "quality": {"kind": "samples", "n": n}})
    return session.render(state, *size)


def _words(metres: float) -> str:
    return (
        f"{metres / 1000:,.3g} km"
        if 1000 <= metres < 1e6
        else f"{metres / 1000:,.0f} km"
        if metres >= 1e6
        else f"{metres:.3g} m"
    )
