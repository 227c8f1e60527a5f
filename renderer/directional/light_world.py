"""A light as the reference is told of it: its models of reflection and the lamp, as plain values and arrays."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from renderer.core.technique import Arrays
from renderer.directional.brdf.materials import table_of
from renderer.directional.environments import image_of, rotation_of
from renderer.world.sky import sky_for
from renderer.world.sun import angles, direction


def light_world(state: Any, baked: Mapping[str, Arrays]) -> dict[str, Any]:
    """The light of a state.

    Args:
        state: the document. baked: arrays by the names of their bakes.

    Returns:
        `parts`, as `renderer.reference.directional_world.part_of` takes them, and `lamp`, with `place` [m] and
        `intensity` [W sr-1], or None where it is out.
    """
    light, lamp = state.light, state.lamp
    shining = {"place": lamp.place, "intensity": tuple(lamp.intensity * share for share in lamp.colour)}
    return {"parts": _PARTS[light.kind](state, baked), "lamp": shining if lamp.lit else None}


def _phong(state: Any, baked: Mapping[str, Arrays]) -> list[dict[str, Any]]:
    own = state.light
    return [_lobe(own) | {"ambient": own.ambient}]


def _measured(state: Any, baked: Mapping[str, Arrays]) -> list[dict[str, Any]]:
    return [_table(baked) | {"ambient": state.light.ambient}]


def _environment(state: Any, baked: Mapping[str, Arrays]) -> list[dict[str, Any]]:
    return [_around(state, baked, state.light.diffuse, state.light.specular)]


def _combined(state: Any, baked: Mapping[str, Arrays]) -> list[dict[str, Any]]:
    own = state.light
    surface = _lobe(own) if own.surface == "phong" else _table(baked)
    around = _around(state, baked, own.matt, own.mirror)
    return [
        surface | {"ambient": 0.0, "weight": own.surface_share},
        around | {"weight": own.environment_share},
    ]


_PARTS = {"phong": _phong, "measured_brdf": _measured, "environment": _environment, "combined": _combined}


def _lobe(own: Any) -> dict[str, Any]:
    return {"kind": "phong", "diffuse": own.diffuse, "specular": own.specular, "exponent": own.shininess}


def _table(baked: Mapping[str, Arrays]) -> dict[str, Any]:
    table = table_of(baked["brdf"])
    return {"kind": "measured", "coordinates": table.coordinates, "nodes": table.nodes, "values": table.values}


def _around(state: Any, baked: Mapping[str, Arrays], diffuse: float, specular: float) -> dict[str, Any]:
    now, sun = sky_for(baked["sky"], angles(state.sun)[1]), np.asarray(direction(state.sun))
    image, turn = image_of(state.environment, baked, now, sun), rotation_of(state.environment)
    return {"kind": "surroundings", "image": image, "rotation": turn, "diffuse": diffuse, "specular": specular}
