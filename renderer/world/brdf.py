"""Reflectance of a surface as a table over directions, in one of three sets of coordinates.

Directions are counted in the surface's own frame: theta from the normal, phi from the tangent towards the bitangent.
`angles` has both directions (Porquet 2005, section 3.3.2.2); `difference` is for surfaces without a grain, where the
azimuths' difference is enough (errata 003-4); `half` has the half vector and the light's place about it (Rusinkiewicz
1998), as the files of Matusik et al. 2003 do.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

Coordinates = Literal["angles", "difference", "half"]

AXES: dict[Coordinates, tuple[str, str, str, str]] = {
    "angles": ("theta_o", "phi_o", "theta_l", "phi_l"),
    "difference": ("theta_o", "", "theta_l", "delta_phi"),
    "half": ("root_theta_h", "", "theta_d", "phi_d"),
}
"""What the four axes of a table count; an axis without a name has one node. o is the view, l the light, delta_phi the
light's azimuth less the view's, h the half vector, d the light seen from it. Angles are radians; root_theta_h is the
square root of theta_h over a right angle."""

PERIODS: dict[Coordinates, tuple[float, float, float, float]] = {
    "angles": (0.0, 2 * math.pi, 0.0, 2 * math.pi),
    "difference": (0.0, 0.0, 0.0, 2 * math.pi),
    "half": (0.0, 0.0, 0.0, math.pi),
}
"""After which an axis comes back to its start; 0: it ends, and what lies beyond has the last node's value."""


@dataclass(frozen=True)
class BrdfTable:
    """A tabulated reflectance.

    Attributes:
        coordinates: what the axes count.
        nodes: of each axis, ascending (see `AXES`).
        values: (nodes of axis 0, 1, 2, 3, 3) red, green and blue, sr-1.
        notes: what its reader should know, in words.
    """

    coordinates: Coordinates
    nodes: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]
    values: np.ndarray
    notes: tuple[str, ...] = field(default=())

    def node_directions(self) -> tuple[np.ndarray, np.ndarray]:
        """View and light (..., 3) of every node, in the shape of `values`.

        Raises:
            ValueError: of a table over half vectors, of whose nodes many lie below the horizon.
        """
        if self.coordinates == "half":
            raise ValueError("nodes over half vectors are no pairs of directions above the horizon")
        theta_o, phi_o, theta_l, phi_l = np.meshgrid(*self.nodes, indexing="ij")
        return direction_of(theta_o, phi_o), direction_of(theta_l, phi_l)


def direction_of(theta: np.ndarray, phi: np.ndarray) -> np.ndarray:
    """Unit vectors (..., 3) in the surface's frame of angles [rad]."""
    level = np.sin(theta)
    return np.stack([level * np.cos(phi), level * np.sin(phi), np.cos(theta)], axis=-1)


def made_one_at_the_pole(table: BrdfTable) -> BrdfTable:
    """The table with one value for all azimuths where theta is 0, their mean: there they are one direction."""
    if table.coordinates == "half":
        return table
    values = table.values.copy()
    for theta, azimuths in ((0, (1, 3) if table.coordinates == "difference" else (1,)), (2, (3,))):
        if table.nodes[theta][0] == 0.0:
            at = np.moveaxis(values, theta, 0)
            own = tuple(axis - (axis > theta) for axis in azimuths)
            at[0] = at[0].mean(axis=own, keepdims=True)
    return BrdfTable(table.coordinates, table.nodes, values, table.notes)
