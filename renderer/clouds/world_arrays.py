"""The clouds as plain arrays and numbers, for whoever draws them without the techniques: the reference."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from renderer.clouds.cloud_map import thickness_map
from renderer.clouds.frame_values import cloud_side, drift, globe_axes
from renderer.clouds.weather import layer_round_site
from renderer.clouds.world_scale import LAND_CELL
from renderer.core.technique import Arrays
from renderer.world.sky import SOLAR_CONSTANT
from renderer.world.sun import ANGULAR_RADIUS, direction

if TYPE_CHECKING:
    from renderer.clouds.state import CloudsState

NEEDS = ("globe", "land", "fields")
"""Bakes that make the world; the others serve techniques."""


def world_arrays(state: CloudsState, baked: Mapping[str, Arrays]) -> dict[str, Any]:
    """What stands where, and the light it stands in.

    Args:
        state: the document; techniques and view are no part of the world.
        baked: arrays of `NEEDS`, and `phase`, of the droplets.

    Returns:
        By name. Planet: `radius` [m]; `albedo` and `snow_albedo` of the site's ground (3,), `snow_line` [m], its
        `rock_albedo` (3,) on slopes above `steepest` [rad], `site_size` [m]; `globe` (rows, columns, 3), the Earth's
        albedo, row 0 at the south pole, column 0 at 180 degrees west, and its axes in the site's, `globe_axes` (3, 3):
        towards 0 E, 90 E and the pole; `height` (N, N) [m] of the land, row 0 at the south, nodes `land_cell` [m]
        apart round the site. Layer: `base`, `thickness` [m], `extinction` [1/m]; `cloud_map` (N, N), thickness as a
        share of the layer's, row 0 at the south, cut at zero once it is read, over a square of `cloud_side` [m] round
        the site, which `cloud_repeats` or not and has been carried by `cloud_drift` (2,) [m]; `systems` (M, M), a
        further share, in Lambert's equal-area projection of the whole Earth round the site; other maps are read at the
        stereographic place of a point; all bilinearly between texels. `moments` (3, L) of the droplets' phase function
        in each band. Light: `sun` (3,), its `sun_radius` [rad] and `sun_irradiance` above the air [W m-2], `haze` of
        the air. `background`, zero: the reference draws the sky itself.
    """
    axes = globe_axes(state.planet.latitude, state.planet.longitude)
    return {
        "radius": state.planet.radius,
        "albedo": tuple(state.planet.albedo),
        "snow_albedo": tuple(state.planet.snow_albedo),
        "snow_line": state.planet.snow_line,
        "rock_albedo": tuple(state.planet.rock_albedo),
        "steepest": math.radians(state.planet.steepest),
        "site_size": state.planet.site_size,
        "globe": (baked["globe"]["albedo"] / 255.0) ** 2,
        "globe_axes": np.array([axes["globe_east"], axes["globe_north"], axes["globe_up"]]),
        "height": baked["land"]["height"],
        "land_cell": LAND_CELL,
        "base": state.layer.base,
        "thickness": state.layer.thickness,
        "extinction": state.layer.extinction,
        "cloud_map": thickness_map(state.clouds, baked["fields"], state.time),
        "cloud_side": cloud_side(state),
        "cloud_repeats": state.clouds.kind != "asset" or state.clouds.repeats,
        "cloud_drift": drift(state),
        "systems": layer_round_site(baked["fields"]["systems"], state.planet, state.layer),
        "sun": tuple(float(v) for v in direction(state.sun)),
        "sun_radius": ANGULAR_RADIUS,
        "sun_irradiance": SOLAR_CONSTANT,
        "haze": state.air.haze,
        "moments": baked["phase"]["moments"],
        "background": lambda directions: np.zeros((len(directions), 3)),
    }
