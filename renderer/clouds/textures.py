"""What was baked, and the moment's maps, as textures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import moderngl
import numpy as np

from renderer.clouds.air import skylight
from renderer.clouds.cloud_map import thickness_map
from renderer.clouds.land import horizon_of_layer, horizon_towards, tops
from renderer.clouds.weather import layer_round_site
from renderer.core.technique import Arrays
from renderer.gl.context import GL
from renderer.gl.program import AnyTexture


def halved(levels: np.ndarray) -> list[np.ndarray]:
    """The coarser levels of a picture (H, W, C): means of 2 x 2 texels."""
    found, levels = [], levels.astype(np.float32)
    while min(levels.shape[:2]) > 1:
        rows, columns = levels.shape[0] // 2, levels.shape[1] // 2
        even, odd = levels[: 2 * rows : 2], levels[1 : 2 * rows : 2]
        beside = even[:, : 2 * columns] + odd[:, : 2 * columns]
        levels = 0.25 * (beside[:, ::2] + beside[:, 1::2])
        found.append(levels)
    return found


def mipmapped(gl: GL, array: np.ndarray, repeat: bool) -> AnyTexture:
    """A float16 or byte texture with its levels."""
    data = array[..., None] if array.ndim == 2 else array
    kind = np.uint8 if data.dtype == np.uint8 else np.float16
    mips = [np.ascontiguousarray(np.rint(level) if kind is np.uint8 else level).astype(kind) for level in halved(data)]
    return gl.texture2d(np.ascontiguousarray(data.astype(kind)), wrap="repeat" if repeat else "clamp", mips=mips)


def world_textures(gl: GL, baked: Mapping[str, Arrays]) -> dict[str, AnyTexture]:
    """Those that last as long as what was baked."""
    highest = tops(baked["land"]["height"])
    return {
        "air_beam": gl.texture2d(baked["air"]["beam"]),
        "air_glow": gl.texture2d(baked["air"]["glow"]),
        "air_skylight": gl.texture2d(skylight(baked["sky"])),
        "globe_albedo": mipmapped(gl, baked["globe"]["albedo"], True),
        "land_tops": gl.texture2d(highest[0], "nearest", mips=highest[1:]),
        "land_heights": gl.texture2d(baked["land"]["height"]),
    }


def weather_texture(gl: GL, fields: Arrays, planet: Any, layer: Any) -> dict[str, AnyTexture]:
    """What weather systems and the layer's front leave of it round the site."""
    return {"cloud_systems": mipmapped(gl, layer_round_site(fields["systems"], planet, layer), False)}


LIT_TOPS = (0.5, 2.0)
"""Shares of the layer's thickness at which its upper side is asked for what summits hide; LAYER_LOW and LAYER_HIGH of
shaders/clouds/ground.glsl."""


def horizon_texture(gl: GL, land: Arrays, azimuth: float, tops: Sequence[float]) -> dict[str, AnyTexture]:
    """The land's horizon towards the sun's azimuth [rad clockwise from north], what it sees of the sky, and the horizon
    of a layer whose upper side lies at two altitudes [m]."""
    layer = (horizon_of_layer(land, azimuth, altitude) for altitude in tops)
    return {"land_horizon": gl.texture2d(np.stack([horizon_towards(land, azimuth), land["open"], *layer], axis=-1))}


def moment_map(gl: GL, clouds: Any, fields: Arrays, side: float, time: float) -> dict[str, AnyTexture]:
    """The thickness map of a moment, and its slopes per metre."""
    made = gl.texture2d(with_slopes(thickness_map(clouds, fields, time), side).astype(np.float16), wrap="repeat")
    made.build_mipmaps()  # sides are powers of two: the driver's levels are means, and time that runs wants them soon
    made.filter = moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR
    return {"cloud_map": made}


def with_slopes(thickness: np.ndarray, side: float) -> np.ndarray:
    """A periodic map (N, N), what it changes per metre to the east and to the north, and what of it is above zero: the
    part whose means are thicknesses, (N, N, 4)."""
    texel = np.float32(side / thickness.shape[0])
    cloud = np.maximum(thickness, 0)
    north, east = ((np.roll(cloud, -1, axis) - np.roll(cloud, 1, axis)) / (2 * texel) for axis in (0, 1))
    return np.stack([thickness, east, north, cloud], axis=-1)


def technique_textures(gl: GL, slot: str, arrays: Mapping[str, np.ndarray]) -> dict[str, AnyTexture]:
    """A technique's arrays as the samplers `<slot>_<name>`: clamped, linear, in float32 or bytes."""
    made: dict[str, AnyTexture] = {}
    for name, array in arrays.items():
        data = np.ascontiguousarray(array if array.dtype in (np.uint8, np.float16) else array.astype(np.float32))
        volume = data.ndim == 4 or (data.ndim == 3 and data.shape[2] > 4)
        made[f"{slot}_{name}"] = gl.texture3d(data) if volume else gl.texture2d(data)
    return made
