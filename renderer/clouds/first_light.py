"""Maps of first light on ground and cloud base over the square around the site: what bounces start from.

The numpy twin of what `shaders/clouds/cloud.glsl` computes at a point of the ground, averaged over cells of half a
cloud height; the Earth is flat over the square.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.ndimage import map_coordinates

from renderer.clouds.air import MARGIN
from renderer.clouds.cloud_map import thickness_curve, turned
from renderer.clouds.first_light_kernel import DEPTHS, gather, light_cells
from renderer.clouds.land import horizon_towards
from renderer.clouds.radiosity.maps import BounceMaps, square_cells
from renderer.clouds.weather import layer_round_site
from renderer.clouds.world_scale import AIR_TOP, LAND_CELL
from renderer.core.technique import Arrays
from renderer.world.camera import pose
from renderer.world.sky import SOLAR_CONSTANT, sky_for
from renderer.world.sun import ANGULAR_RADIUS, angles, direction

if TYPE_CHECKING:
    from renderer.clouds.state import CloudsState

WITHIN = 4
"""Places along each side of a cell whose mean it takes."""

HIGHEST = 0.9
"""Ground that rises above this share of the base's height is taken to lie there: mountains do not pierce the layer."""

DRIFTED = 1 / 8
"""Part of a cell that the layer drifts before its light is bounced anew."""

DISC = 2 * ANGULAR_RADIUS
"""Width of the sun's disc, rad."""

KEEP = 2
"""Grounds and layers kept while only the sun moves."""


WIDEST = 4.0
"""Of the square against that of side 32H: within it the sun stands everywhere alike to 1.5 degrees."""


def reach(state: CloudsState) -> float:
    """Height to which the square's cells are cut, m: the base's, or twice or four times it where the camera is far off.

    A far camera has a wider square of as many cells (Belcour 2009, section 5.2.3: several resolutions by distance).
    """
    return _reach(state.camera, state.layer.base)


@functools.lru_cache(maxsize=16)
def _reach(camera: Any, base: float) -> float:
    off = float(np.linalg.norm(pose(camera).eye - np.array((0.0, 0.0, base))))
    return base * float(np.clip(2.0 ** np.floor(np.log2(max(off / (16 * base), 1.0))), 1.0, WIDEST))


def moment(state: CloudsState) -> float:
    """The document's time, s, in steps in which the layer drifts by a part of a cell."""
    step = DRIFTED * square_cells(state.layer.base)[1] / max(state.layer.wind, 1.0)
    return math.floor(state.time / step) * step


@dataclass(frozen=True)
class Land:
    """The ground of the square at `WITHIN` places a cell and side.

    Attributes:
        height: m, means over cells (GRID, GRID), row 0 at the south. albedo: (P, P, 3).
        slopes: rise to the east and to the north, and one over the normal's length, (P, P, 3).
        nodes: of the land, two of its own wide, at the places along either axis, (P,); -1 beyond its edge.
    """

    height: np.ndarray
    albedo: np.ndarray
    slopes: np.ndarray
    nodes: np.ndarray


GROUNDS: list[tuple[Arrays, tuple[Any, ...], Land]] = []
LAYERS: list[tuple[Arrays, tuple[Any, ...], np.ndarray]] = []
WEATHERS: list[tuple[Arrays, tuple[Any, ...], np.ndarray]] = []


def places(wide: float) -> np.ndarray:
    """Coordinates of the sampled places along either axis, m from the site, (P,), of a square of that reach [m]."""
    n, cell = square_cells(wide)
    return ((np.arange(n * WITHIN) + 0.5) / WITHIN - n / 2) * cell


def cells(field: np.ndarray) -> np.ndarray:
    """Means over cells of what was sampled, (P, P[, C]) to (GRID, GRID[, C])."""
    # Sums of strided pictures: a mean over two axes at once takes four times as long.
    rows = np.asarray(sum(field[k::WITHIN] for k in range(WITHIN)))
    return np.asarray(sum(rows[:, k::WITHIN] for k in range(WITHIN))) / WITHIN**2


def land_of(land: Arrays, planet: Mapping[str, Any], wide: float) -> Land:
    """The ground of the square.

    Args:
        land: of `bake_land`. planet: `albedo`, `snow_albedo`, `snow_line`. wide: the square's reach, m.
    """
    heights = np.asarray(land["height"], np.float64)
    coarse = heights.reshape(len(heights) // 2, 2, -1, 2).mean(axis=(1, 3))
    north, east = np.gradient(coarse, 2 * LAND_CELL)
    nodes = np.floor(places(wide) / (2 * LAND_CELL) + len(coarse) / 2).astype(np.int32)
    nodes[(nodes < 0) | (nodes >= len(coarse))] = -1
    inside = (nodes[:, None] >= 0) & (nodes[None, :] >= 0)
    height, east, north = (np.where(inside, field[np.ix_(nodes, nodes)], 0.0) for field in (coarse, east, north))
    t = np.clip((height - planet["snow_line"]) / 120 + 0.5, 0, 1)
    snow = (t * t * (3 - 2 * t))[..., None]
    albedo = np.array(planet["albedo"]) * (1 - snow) + np.array(planet["snow_albedo"]) * snow
    slopes = np.stack([east, north, 1 / np.sqrt(1 + east**2 + north**2)], axis=-1)
    return Land(cells(height), albedo, slopes.astype(np.float32), nodes)


def _ground(state: CloudsState, land: Arrays) -> Land:
    """The ground of a document's square, kept while only the sun moves."""
    planet = {name: getattr(state.planet, name) for name in ("albedo", "snow_albedo", "snow_line")}
    wide = reach(state)
    return _kept(GROUNDS, land, (*planet.values(), wide), lambda: land_of(land, planet, wide))


def _overhead(state: CloudsState, fields: Arrays) -> np.ndarray:
    """Optical depth over the places, kept while only the sun moves."""
    key = (state.layer, state.clouds, state.planet, moment(state), reach(state))
    return _kept(LAYERS, fields, key, lambda: depth_at(state, fields, (0.0, 0.0)))


def _kept(known: list[tuple[Arrays, tuple[Any, ...], Any]], arrays: Arrays, key: tuple[Any, ...], make: Any) -> Any:
    """What was made of some arrays and a key, or a new one in the place of the oldest."""
    for entry in known:
        if entry[0] is arrays and entry[1] == key:
            return entry[2]
    made = make()
    known[:] = [(arrays, key, made), *known[: KEEP - 1]]
    return made


def _weather(state: CloudsState, fields: Arrays) -> np.ndarray:
    """What the weather leaves of the layer over the places, (P, P); the same for all moves, which it is wider than."""
    planet, wide = state.planet, reach(state)

    def make() -> np.ndarray:
        systems = layer_round_site(fields["systems"], planet, state.layer)
        at = (0.5 + places(wide) / (4 * planet.radius)) * len(systems) - 0.5
        grid = np.meshgrid(at, at, indexing="ij")
        return np.asarray(map_coordinates(systems, grid, order=1, mode="nearest"), np.float32)

    return _kept(WEATHERS, fields, (planet, wide, state.layer.ends, state.layer.ends_azimuth), make)


def depth_at(state: CloudsState, fields: Arrays, shift: tuple[float, float]) -> np.ndarray:
    """Optical depth of the layer over the sampled places moved by `shift` [m], (P, P)."""
    layer, clouds, time = state.layer, state.clouds, moment(state)
    weather, thickest = _weather(state, fields), layer.extinction * layer.thickness
    if clouds.kind == "uniform":
        return weather * np.float32(thickest)
    way, azimuth = layer.wind * time, math.radians(layer.wind_azimuth)
    along = places(reach(state))
    x = along + shift[0] - way * math.sin(azimuth)
    y = along + shift[1] - way * math.cos(azimuth)
    texels = fields["fields"].shape[1]
    u, v = (np.floor((w / clouds.side + 0.5) * texels).astype(np.int64) for w in (x, y))
    curve, lowest, finest = thickness_curve(clouds)
    both = fields["fields"] if len(fields["fields"]) == 2 else np.repeat(fields["fields"], 2, axis=0)
    turn = np.asarray(turned(clouds, time), np.float32)
    axis = np.array([lowest, finest, thickest], np.float32)
    found = gather(both, turn, v % texels, u % texels, curve, axis, weather)
    if clouds.kind == "asset" and not clouds.repeats:
        found *= ((v >= 0) & (v < texels))[:, None] & ((u >= 0) & (u < texels))[None, :]
    return np.asarray(found)


def bounce_maps(state: CloudsState, baked: Mapping[str, Arrays]) -> BounceMaps:
    """First light of a document's sun and moment.

    Args:
        baked: arrays by name: `sky`, `air`, `land`, `fields`, and what the scattering technique asks for.
    """
    azimuth, elevation = angles(state.sun)
    sun, mu = direction(state.sun), math.sin(elevation)
    light = sky_for(baked["sky"], elevation)
    base = state.layer.base
    land = _ground(state, baked["land"])
    slant = min(base / max(mu, 0.02), 20 * base)
    depth = _overhead(state, baked["fields"])
    along = depth_at(state, baked["fields"], (slant * sun[0], slant * sun[1]))

    model = state.scattering.model(baked)
    steep = np.full_like(DEPTHS, max(mu, 0.02))
    direct = _bands(model.direct(DEPTHS, steep))
    scattered = np.maximum(model.transmittance(DEPTHS, steep) - direct, 0)
    even = model.diffuse_reflectance(DEPTHS)
    above = light.sun_irradiance * max(mu, 0.0) * scattered + light.sky_irradiance * (1 - even)
    tables = (np.concatenate([above, even], axis=1), light.sun_irradiance * direct)
    wide, narrow = (np.asarray(table, np.float32) for table in tables)
    horizon = horizon_towards(baked["land"], azimuth)
    sharpness = np.float32(1 / (DISC * max(math.cos(elevation), 0.01)))
    seen = (np.asarray(sun, np.float32), sharpness, land.slopes, horizon, land.nodes)
    ground, sent, reflectance = light_cells(WITHIN, *seen, land.albedo, depth, wide, along, narrow)
    n, cell = square_cells(reach(state))
    below = _beam(baked["air"], base, mu) * SOLAR_CONSTANT * max(-mu, 0.0)
    return BounceMaps(
        cell=cell,
        height=base,
        elevation=np.minimum(land.height, HIGHEST * base),
        albedo=sent / np.maximum(ground, 1e-9),
        reflectance=reflectance,
        ground=ground,
        cloud=np.broadcast_to(below, (n, n, 3)),
    )


def _bands(values: np.ndarray) -> np.ndarray:
    values = np.asarray(values)
    return values if values.ndim == 2 else np.repeat(values[:, None], 3, axis=1)


def _beam(air: Arrays, altitude: float, mu: float) -> np.ndarray:
    """Share of the sun's light that arrives at a height [m], (3,): from the table of `bake_air`."""
    table = np.asarray(air["beam"], np.float64)
    rows, columns = table.shape[:2]
    radius = 6.36e6 + altitude
    dip = math.sqrt(altitude * (2 * 6.36e6 + altitude)) / radius
    above = ((mu + dip) / (1 + dip) + MARGIN) / (1 + MARGIN)
    if above < 0:
        return np.zeros(3)
    at = [[math.sqrt(altitude / AIR_TOP) * (rows - 1)], [math.sqrt(above) * (columns - 1)]]
    return np.array([map_coordinates(table[..., band], at, order=1, mode="nearest")[0] for band in range(3)])


def bake_bounce_ground(arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Any) -> dict[str, np.ndarray]:
    """The ground of the square for transfer matrices: `elevation` [m] and `albedo`, (GRID, GRID[, 3])."""
    progress(0.0, "averaging the land over the square")
    land = land_of(inputs["land"], arguments, arguments["height"])
    elevation = np.minimum(land.height, HIGHEST * arguments["height"])
    return {"elevation": elevation, "albedo": cells(land.albedo)}
