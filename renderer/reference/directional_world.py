"""The directional textures' world as their reference reads it: a mesh, and the light it stands in, as plain arrays.

Nothing of clouds of points, faces of a box or hemispheres of directions: those are the method's, which this judges.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

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


@dataclass(frozen=True)
class Table:
    """A BRDF between nodes, bilinear by each direction's two angles.

    Attributes:
        values: (To, Po, Tl, Pl, 3) for every eye and light, 1/sr; isotropic (To, Tl, P, 3), P being the azimuth from
            the eye's to the light's.
        theta_o, theta_l: from the normal [rad], rising; beyond the last the last counts.
        phi_o, phi_l: from the tangent [rad], rising within a turn, which closes; isotropic `phi_l` for P, `phi_o` None.
    """

    values: NDArray[np.floating]
    theta_o: NDArray[np.floating]
    theta_l: NDArray[np.floating]
    phi_l: NDArray[np.floating]
    phi_o: NDArray[np.floating] | None = None


@dataclass(frozen=True)
class Merl:
    """A measured material in the half vector's coordinates (Matusik et al. 2003), as its file holds it.

    Attributes:
        values: (theta_h, theta_d, phi_d, 3) BRDF, 1/sr, the file's scales applied; below 0 where nothing was measured.
    """

    values: NDArray[np.floating]


@dataclass(frozen=True)
class Measured:
    """A measured material in the sun.

    Attributes:
        brdf: what it reflects. ambient: share of the colour that answers the sky, as in `Phong`.
    """

    brdf: Table | Merl
    ambient: float = 0.0


Part = Phong | Surroundings | Measured


@dataclass(frozen=True)
class DirectionalWorld:
    """What stands there, in metres, z up, and the light it stands in.

    Attributes:
        vertices: (V, 3). faces: (F, 3) indices. normals: (F, 3, 3) unit, at the faces' corners, linear between them.
        colour: (F, 3) linear reflectance.
        two_sided: whether a face seen from behind turns its normal.
        sun: unit vector to it. e_sun: irradiance facing it. e_sky: of the sky on the horizontal. All W m-2.
        parts: models of reflection and their weights; what they send adds up.
        lamp: a point light that Phong's model answers, too.
        shadows: whether the subject shadows itself, by sun, lamp, sky and mirror.
        background: radiance behind everything, for directions (M, 3) -> (M, 3); None leaves it empty.
    """

    vertices: NDArray[np.floating]
    faces: NDArray[np.integer]
    normals: NDArray[np.floating]
    colour: NDArray[np.floating]
    two_sided: bool = False
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


def _check(part: Part) -> None:
    """Refuse pictures and tables whose sides do not fit."""
    if isinstance(part, Surroundings) and (part.image.ndim != 3 or part.image.shape[2] != 3):
        raise InputError("image", f"has shape {part.image.shape}", "(H, W, 3)")
    if isinstance(part, Measured) and isinstance(part.brdf, Table):
        table = part.brdf
        nodes = [table.theta_o, *([] if table.phi_o is None else [table.phi_o]), table.theta_l, table.phi_l]
        wanted = (*(len(each) for each in nodes), 3)
        if table.values.shape != wanted:
            raise InputError("values", f"has shape {table.values.shape}", str(wanted))
