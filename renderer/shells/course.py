"""Key frames: what bends, grows, thins, fades and slides as time runs.

Dufort 2005, section 5.3.3, animates a shell's mesh, its texture, its materials' opacities and its texture coordinates.
None of the latter three needs a precomputation here; what the mesh does between two key frames is `animation`'s.
"""

from __future__ import annotations

import bisect
from collections.abc import Sequence
from dataclasses import dataclass

from renderer.core.params import Model, param
from renderer.shells.texture.source import Source
from renderer.shells.texture.sources import moment_of

MOST_KEYS = 64
"""Key frames that a document may hold."""


class Key(Model):
    """What texture and surface are at one time; between two of them they change evenly."""

    at: float = param(0.0, label="Time", help="Of the key frame.", unit="s", cost="host", ge=0, le=3600)
    growth: float = param(
        1.0, label="Growth", help="Factor on the strands' growth.", unit="ratio", cost="host", ge=0, le=1
    )
    density: float = param(
        1.0, label="Density", help="Factor on the share of strands.", unit="ratio", cost="host", ge=0, le=1
    )
    second: float = param(
        1.0, label="Second material", help="Factor on its opacity.", unit="ratio", cost="host", ge=0, le=1
    )
    opacity: float = param(
        1.0, label="Opacity", help="Factor on the extinction of all matter.", unit="ratio", cost="host", ge=0, le=4
    )
    slide_u: float = param(
        0.0, label="Slide along u", help="Of the texture over the surface, in repeats.", cost="host", ge=-100, le=100
    )
    slide_v: float = param(0.0, label="Slide along v", help="Likewise.", cost="host", ge=-100, le=100)
    bend: float = param(
        0.0, label="Bend", help="Of the surface about the y axis, from foot to top.", unit="deg", cost="host", ge=-360,
        le=360, source="Barr 1984",
    )
    twist: float = param(
        0.0, label="Twist", help="Of the surface about the z axis, from foot to top.", unit="deg", cost="host", ge=-720,
        le=720, source="Barr 1984",
    )
    swell: float = param(
        0.0, label="Swell", help="Of the surface along its normals.", unit="m", cost="host", ge=-100, le=100
    )


VALUES = tuple(name for name in Key.model_fields if name != "at")
"""What changes from key frame to key frame."""


class Course(Model):
    """How texture and surface change as time runs."""

    period: float = param(
        6.0, label="Period", help="After which the key frames come round.", unit="s", cost="host", gt=0, le=3600,
        step=0.1,
    )
    keys: tuple[Key, ...] = param(
        (), label="Key frames", help="Without any all stays as it is.", cost="host", max_length=MOST_KEYS,
        source="Dufort 2005, section 5.3.3",
    )


@dataclass(frozen=True)
class TextureMoment:
    """A texture at a moment.

    Attributes:
        words: keywords of `texture_of`: growth, density and second, those that the source has.
        slide: of its coordinates u and v, in repeats; whole ones are left out where the texture comes round.
        opacity: factor on the extinction of all matter.
    """

    words: dict[str, float]
    slide: tuple[float, float]
    opacity: float = 1.0


def texture_moment(texture: Source, course: Course, time: float, wraps: bool = True) -> TextureMoment:
    """The texture's own values times the key frames' at a time [s].

    Args:
        wraps: whether the texture repeats, so that whole repeats of a slide do nothing.
    """
    own = moment_of(texture)
    if not course.keys:
        return TextureMoment(own, (0.0, 0.0))
    now = key_at(course, time)
    u, v = (now.slide_u % 1.0, now.slide_v % 1.0) if wraps else (now.slide_u, now.slide_v)
    return TextureMoment({name: value * float(getattr(now, name)) for name, value in own.items()}, (u, v), now.opacity)


def key_at(course: Course, time: float) -> Key:
    """What the key frames say at a time [s]: even between two, and from the last on to the first of the next round.

    A slide goes on from where the last key frame left it to where the first begins: a key frame at the period's end is
    how a slide by whole repeats comes round unseen.
    """
    keys = sorted(course.keys, key=lambda key: key.at)
    early, late, share = between([key.at for key in keys], course.period, time)
    one, other = keys[early], keys[late]
    found = {name: getattr(one, name) + share * (getattr(other, name) - getattr(one, name)) for name in VALUES}
    return Key(at=min(time % course.period, 3600.0), **found)


def between(times: Sequence[float], period: float, time: float) -> tuple[int, int, float]:
    """The two key frames between which a time lies, and the share of the way from the first to the second.

    Args:
        times: of the key frames, rising [s]; from the last on to the first of the next round, where the last comes
            before the round's end. period: of a round [s]. time: any [s].
    """
    place, last = time % period, len(times) - 1
    after = bisect.bisect_right(times, place)
    early, late = (after - 1, after) if 0 < after <= last else (last, 0)
    begin, end = times[early], times[late]
    if after > last:
        end += period
    elif after == 0:
        begin = min(begin - period, 0.0)  # a key frame at the round's end, or behind it, is where the next begins
    return early, late, (place - begin) / (end - begin) if end > begin else 0.0
