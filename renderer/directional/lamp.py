"""A lamp beside the subject: a point of light at a place of its own."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from renderer.core.params import Colour, Model, Vector3, param
from renderer.core.technique import Arrays


class Lamp(Model):
    """A point that shines evenly to all sides."""

    lit: bool = param(False, label="Lit", help="Whether it shines.", cost="build")
    place: Vector3 = param((0.9, -1.0, 1.2), label="Place", help="Where it is.", unit="m", cost="host")
    intensity: float = param(600.0, label="Intensity", help="Of its light.", unit="W sr-1", ge=0, le=1e9)
    colour: Colour = param((1.0, 0.82, 0.6), label="Colour", help="Of its light.")


LAMP_DECLARATIONS = "uniform vec3 lamp_position;       // m from the box's middle"


def lamp_values(lamp: Lamp, baked: Mapping[str, Arrays]) -> dict[str, Any]:
    """Values of `LAMP_DECLARATIONS`.

    Args:
        baked: arrays by the names of their bakes; `visibility` has the box.
    """
    middle = np.asarray(baked["visibility"]["box"]).mean(axis=0)
    return {"lamp_position": tuple(float(v) for v in np.array(lamp.place) - middle)}
