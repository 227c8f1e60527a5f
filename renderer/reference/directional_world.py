"""The directional textures' world as their reference reads it: a mesh, and the light it stands in, as plain arrays.

Nothing of clouds of points, faces of a box or hemispheres of directions: those are the method's, which this judges.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from renderer.core.errors import InputError

Floats = NDArray[np.float64]
Colour3 = tuple[float, float, float]


@dataclass(frozen=True)
class Lamp:
    """A point that shines alike to all sides.

    Attributes:
        place: metres. intensity: W/sr, by channel.
    """

    place: Colour3
    intensity: Colour3


@dataclass(frozen=True)
class Phong:
    """Phong's model, its lobe normalised by (exponent + 2) / 2 pi (Lafortune & Willems 1994).

    Attributes:
        ambient, diffuse, specular: shares. The sky's light comes by `ambient`, from the open part of the upper dome.
    """

    ambient: float
    diffuse: float
    specular: float
    exponent: float


@dataclass(frozen=True)
class Surroundings:
    """Light from a picture of all directions: mirrored, and gathered by the colour.

    Attributes:
        image: (H, W, 3) radiance, W m-2 sr-1; row 0 at the zenith, column by azimuth clockwise from north.
        rotation: of the picture about the zenith, clockwise [rad].
        diffuse, specular: shares of what is gathered and of what is mirrored.
    """

    image: NDArray[np.floating]
    rotation: float
    diffuse: float
    specular: float


Coordinates = Literal["angles", "difference", "half"]


@dataclass(frozen=True)
class Measured:
    """A material as a table, linear in each coordinate between its nodes.

    Attributes:
        coordinates: what the four axes count, o being the eye and l the light. `angles`: theta_o, phi_o, theta_l,
            phi_l. `difference`: theta_o, one node, theta_l, phi_l - phi_o. `half` (Rusinkiewicz 1998, as the files of
            Matusik et al. 2003): the square root of theta_h over a right angle, one node, theta_d, phi_d.
        nodes: of each axis, rising; angles [rad], theta from the normal, phi from the tangent. Beyond the ends of an
            axis its last node counts; azimuths close after a turn, phi_d after a half.
        values: (a, b, c, d, 3) BRDF, 1/sr.
        ambient: share of the colour that answers the sky, as in `Phong`.
    """

    coordinates: Coordinates
    nodes: tuple[NDArray[np.floating], NDArray[np.floating], NDArray[np.floating], NDArray[np.floating]]
    values: NDArray[np.floating]
    ambient: float = 0.0


Part = Phong | Surroundings | Measured


@dataclass(frozen=True)
class DirectionalWorld:
    """What stands there, in metres, z up, and the light it stands in.

    Attributes:
        vertices: (V, 3). faces: (F, 3) indices. normals: (F, 3, 3) unit, at the faces' corners, linear between them.
        colour: (F, 3) linear reflectance.
        two_sided: whether a face seen from behind turns its normal.
        lift: how far off a face a ray to the light begins beside what rounding asks for, m: faces that stand for points
            rise over one another.
        sun: unit vector to it. e_sun: irradiance facing it. e_sky: of the sky on the horizontal. All W m-2.
        parts: models of reflection and their weights; what they send adds up.
        lamp: a point light beside the sun.
        shadows: whether the subject shadows itself, by sun, lamp, sky and mirror.
        background: radiance behind everything, for directions (M, 3) -> (M, 3); None leaves it empty.
    """

    vertices: NDArray[np.floating]
    faces: NDArray[np.integer]
    normals: NDArray[np.floating]
    colour: NDArray[np.floating]
    two_sided: bool = False
    lift: float = 0.0
    sun: Colour3 = (0.0, 0.0, 1.0)
    e_sun: Colour3 = (0.0, 0.0, 0.0)
    e_sky: Colour3 = (0.0, 0.0, 0.0)
    parts: tuple[tuple[float, Part], ...] = field(default=())
    lamp: Lamp | None = None
    shadows: bool = True
    background: Callable[[Floats], Floats] | None = None

    def __post_init__(self) -> None:
        """Refuse arrays that do not fit.

        Raises:
            InputError: naming the wrong one.
        """
        count = len(self.faces)
        if self.vertices.ndim != 2 or self.vertices.shape[1] != 3 or not np.isfinite(self.vertices).all():
            raise InputError("vertices", f"has shape {self.vertices.shape}", "(V, 3) finite metres")
        if self.faces.ndim != 2 or self.faces.shape[1] != 3 or not count:
            raise InputError("faces", f"has shape {self.faces.shape}", "(F, 3), F at least 1")
        if self.faces.min() < 0 or self.faces.max() >= len(self.vertices):
            raise InputError("faces", "names a vertex that is not there", f"0 to {len(self.vertices) - 1}")
        for name, found, wanted in (
            ("normals", self.normals.shape, (count, 3, 3)),
            ("colour", self.colour.shape, (count, 3)),
        ):
            if found != wanted:
                raise InputError(name, f"has shape {found}", str(wanted))
        for _, part in self.parts:
            _check(part)


def part_of(plain: Mapping[str, Any]) -> tuple[float, Part]:
    """A part and its weight from plain values.

    Args:
        plain: `kind` (`phong`, `surroundings`, `measured`), the fields of that part by name, and `weight`, 1 where
            there is none.

    Raises:
        InputError: another kind.
    """
    given = {name: value for name, value in plain.items() if name not in ("kind", "weight")}
    weight = float(plain.get("weight", 1.0))
    kinds: Mapping[str, type[Part]] = {"phong": Phong, "surroundings": Surroundings, "measured": Measured}
    if plain["kind"] in kinds:
        return weight, kinds[plain["kind"]](**given)
    raise InputError("kind", "names no light", "phong, surroundings or measured")


def _check(part: Part) -> None:
    """Refuse pictures and tables whose sides do not fit."""
    if isinstance(part, Surroundings) and (part.image.ndim != 3 or part.image.shape[2] != 3):
        raise InputError("image", f"has shape {part.image.shape}", "(H, W, 3)")
    if isinstance(part, Measured):
        wanted = (*(len(each) for each in part.nodes), 3)
        if part.values.shape != wanted:
            raise InputError("values", f"has shape {part.values.shape}", str(wanted))
