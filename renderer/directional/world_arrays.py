"""What is seen, as plain arrays and numbers, for whoever draws it without the techniques: the reference."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from renderer.core.technique import Arrays
from renderer.directional.environments import background_of
from renderer.directional.light_world import light_world
from renderer.world.sky import sky_for
from renderer.world.sun import angles, direction

if TYPE_CHECKING:
    from renderer.directional.state import DirectionalState

NEEDS = ("sky", "subject", "brdf", "environment")
"""Bakes that make the world, as far as a state has them."""


def world_arrays(state: DirectionalState, baked: Mapping[str, Arrays]) -> dict[str, Any]:
    """The mesh and the light it stands in.

    Args:
        state: the document; techniques but the light, and the view, are no part of the world.
        baked: arrays of `NEEDS`.

    Returns:
        By name: `vertices`, `faces`, `normals` of corners, `colour` of faces, `two_sided` and `lift` of the mesh;
        `sun`, `e_sun`, `e_sky` and the `background`; and `light`, whose `parts` are models of reflection, with the
        `lamp`, or None.
    """
    now, sun = sky_for(baked["sky"], angles(state.sun)[1]), direction(state.sun)
    subject = baked["subject"]
    return {
        **{name: subject[name] for name in ("vertices", "faces", "normals", "colour")},
        "two_sided": bool(subject["two_sided"]),
        "lift": float(subject.get("lift", 0.0)),
        "sun": tuple(float(v) for v in sun),
        "e_sun": tuple(float(v) for v in now.sun_irradiance),
        "e_sky": tuple(float(v) for v in now.sky_irradiance),
        "light": light_world(state, baked),
        "background": background_of(state, baked, now, np.asarray(sun)),
    }
