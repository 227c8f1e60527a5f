"""Key frames of a texture: what grows, thins, fades and slides as time runs.

Dufort 2005, section 5.3.3, animates a shell's texture, its materials' opacities and its texture coordinates beside its
mesh. None of them needs a precomputation here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from renderer.core.params import Model, param
from renderer.shells.texture.source import Source
from renderer.shells.texture.sources import moment_of

MOST_KEYS = 64
"""Key frames that a document may hold."""


class Key(Model):
    """What the texture is at one time; between two of them it changes evenly."""

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
    slide_u: float = param(
        0.0, label="Slide along u", help="Of the texture over the surface, in repeats.", cost="host", ge=-100, le=100
    )
    slide_v: float = param(0.0, label="Slide along v", help="Likewise.", cost="host", ge=-100, le=100)


class Course(Model):
    """How the texture changes as time runs."""

    period: float = param(
        6.0, label="Period", help="After which the key frames come round.", unit="s", cost="host", gt=0, le=3600,
        step=0.1,
    )
    keys: tuple[Key, ...] = param(
        (), label="Key frames", help="Without any the texture stays as it is.", cost="host", max_length=MOST_KEYS,
        source="Dufort 2005, section 5.3.3",
    )


@dataclass(frozen=True)
class TextureMoment:
    """A texture at a moment.

    Attributes:
        words: keywords of `texture_of`: growth, density and second, those that the source has.
        slide: of its coordinates u and v, in repeats; whole ones are left out where the texture comes round.
    """

    words: dict[str, float]
    slide: tuple[float, float]


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
    return TextureMoment({name: value * float(getattr(now, name)) for name, value in own.items()}, (u, v))


def key_at(course: Course, time: float) -> Key:
    """What the key frames say at a time [s]: even between two, and from the last on to the first of the next round.

    A slide goes on from where the last key frame left it to where the first begins: a key frame at the period's end is
    how a slide by whole repeats comes round unseen.
    """
    keys = sorted(course.keys, key=lambda key: key.at)
    place = time % course.period
    times = np.array([key.at for key in keys])
    names = ("growth", "density", "second", "slide_u", "slide_v")
    values = np.array([[getattr(key, name) for name in names] for key in keys])
    if times[-1] < course.period:
        times, values = np.append(times, times[0] + course.period), np.vstack([values, values[:1]])
    if place < times[0]:
        place += course.period
    found = [float(np.interp(place, times, column)) for column in values.T]
    return Key(at=place if place <= 3600 else 3600.0, **dict(zip(names, found, strict=True)))
