"""Where shadow hemispheres fail: few harmonics ring, and few directions miss grazing light. Numbers and charts."""

from __future__ import annotations

from functools import cache

import numpy as np

from renderer.core.failure import Charted, ChartedFailure, Curve
from renderer.core.params import bake_arguments
from renderer.directional.cloud import bake_cloud
from renderer.directional.codes.bits import Bits
from renderer.directional.codes.code import Code, decode, places_of
from renderer.directional.codes.codebook import learn
from renderer.directional.codes.harmonics import Harmonics
from renderer.directional.codes.harmonics import ringing as rings
from renderer.directional.frames import quantised
from renderer.directional.hemisphere import hemisphere_of
from renderer.directional.shadow_hemispheres import Caster, shadow_bits, unpacked, world_directions
from renderer.directional.subject.knot import Knot
from renderer.directional.subjects import bake_subject

POINTS = 1500
"""Of the knot, at which all is measured."""

RAYS = 48
"""Random directions of each at every height."""

HEIGHTS = (2.0, 4.0, 6.0, 9.0, 14.0, 22.0, 35.0, 60.0)
"""Of the light above a point's own horizon, degrees; grazing are those up to `GRAZING`."""

GRAZING = 6.0


def quiet(share: float, words: str) -> None:
    """Progress of what takes a moment."""


@cache
def _knot() -> tuple[Caster, np.ndarray, np.ndarray]:
    """The default knot under rays, with some of its points and their normals."""
    subject = bake_subject(bake_arguments(Knot()), {}, quiet)
    cloud = bake_cloud({"points": 100_000}, {"subject": subject}, quiet)
    which = np.linspace(0, len(cloud["position"]) - 1, POINTS).astype(int)
    normals = quantised(cloud["normal"][which].astype(np.float64))
    return Caster(subject["vertices"], subject["faces"]), cloud["position"][which], normals


def _masks(count: int) -> np.ndarray:
    bits, _ = shadow_bits(*_knot(), hemisphere_of(count), quiet)
    return unpacked(bits, count)


def ringing() -> Charted:
    """How often harmonics leave 0 to 1 by more than a tenth before the clamp, against how many there are; learnt
    patterns never do. The case's own are the four of nine bytes."""
    layout, masks = hemisphere_of(129), _masks(129)
    codes = [Harmonics(layout, size) for size in (5, 9, 17, 33)]
    share = np.array([rings(decode(code, code.encode(masks)))[0] for code in codes])
    book = learn(layout, 9, masks)
    kept = rings(decode(book, book.encode(masks)))[0]
    count = np.array([code.kept for code in codes], float)
    curves = (Curve("failing", count, share), Curve("surviving", count, np.full(4, kept)))
    return Charted(float(share[1]), kept, curves, "harmonics", "share of values beyond 0 to 1 by a tenth")


def grazing() -> Charted:
    """How many directions of light are misjudged by its height above the point's horizon: nearest of 129 directions,
    and blended of 513. The case's own are those up to `GRAZING` degrees."""
    caster, positions, normals = _knot()
    turn = np.random.default_rng(5).random((POINTS, len(HEIGHTS), RAYS)) * 2 * np.pi
    height = np.broadcast_to(np.radians(HEIGHTS)[:, None], turn.shape)
    local = np.stack([np.cos(height) * np.cos(turn), np.cos(height) * np.sin(turn), np.sin(height)], axis=-1)
    flat = local.reshape(POINTS, -1, 3)
    truth = caster.open(positions, normals, world_directions(normals, flat))
    codes: tuple[Code, ...] = (Bits(hemisphere_of(129), blend=False), Bits(hemisphere_of(513)))
    wrong = []
    for code in codes:
        seen = code.evaluate(code.encode(_masks(code.layout.count)), places_of(code.layout, flat)) > 0.5
        wrong.append((seen != truth).reshape(turn.shape).mean(axis=(0, 2)))
    low = np.array(HEIGHTS) <= GRAZING
    curves = (Curve("failing", np.array(HEIGHTS), wrong[0]), Curve("surviving", np.array(HEIGHTS), wrong[1]))
    return Charted(float(wrong[0][low].mean()), float(wrong[1][low].mean()), curves,
                   "height of the light above the horizon, degrees", "share of directions misjudged")  # fmt: skip


SHADOW_FAILURES = (
    ChartedFailure(
        name="ringing_harmonics",
        title="Few harmonics ring",
        failing="principal harmonics, nine bytes",
        surviving="learnt patterns, nine bytes",
        symptom="share of a knot's visibilities that leave 0 to 1 by more than a tenth before the clamp",
        threshold=0.02,
        measured=(0.073, 0.0),
        cause="Shadows have sharp edges, beside which a few waves swing over and under.",
        measure="renderer.directional.shadow_failures:ringing",
    ),
    ChartedFailure(
        name="grazing_light",
        title="Grazing light falls between directions",
        failing="the nearest of 129 directions",
        surviving="513 directions, blended",
        symptom="share of directions of light up to 6 degrees above a point's horizon that are misjudged, on a knot",
        threshold=0.09,
        measured=(0.124, 0.065),
        cause="The lowest row stands for all light up to 10.6 degrees, in which most of a surface's own relief begins.",
        measure="renderer.directional.shadow_failures:grazing",
    ),
)
"""Cases of shadow hemispheres, for the scene's catalogue."""
