"""The sky: radiance of every direction, irradiance of sun and sky, by the sun's elevation.

One bake gives three tables; `sky_for` takes from them what one sun needs: two colours of light and a small picture of
the sky (view elevation x azimuth from the sun), which `shaders/lib/sky.glsl` reads with one fetch.

Units: W m-2 and W m-2 sr-1, where each of the three bands stands for the whole solar constant. So sunlight above the
air is white, (1, 1, 1) times 1361 W m-2, and all colour comes from the air (as in Hillaire 2020, with unit irradiance).

Deviations: haze of one kind, a spherical Earth, no refraction, no polarisation; multiple scattering is isotropic and
summed in closed form. Three wavelengths shown as red, green and blue make deep twilight more purple than a spectrum
would, because ozone takes more of 600 nm than of 680 nm. By day, against a spectrum seen by the CIE's observer and
relative to green, skylight has a tenth too little red in very clear air and is right to 2 % on a common day; sunlight
has 5 % too much red at 45 degrees and 19 % at 10 (`tests/world/test_sky_colours.py`). White is the sun above the air,
as with a camera set to daylight: shade under a very clear sky is a tenth as bright as the sun beside it and deeply
blue, (0.5, 1, 2.2) for white ground; on a common day, haze 20, it is a fifth and (0.8, 1, 1.5). A sky is clear or
wholly overcast (`renderer/world/overcast.py`); below the horizon it repeats the horizon's colour.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from renderer.core.params import validate
from renderer.world import atmosphere
from renderer.world.atmosphere import GROUND, MIE_ASYMMETRY, Air, Atmosphere, Floats
from renderer.world.overcast import overcast
from renderer.world.sky_picture import MOMENTS, VIEW_SHAPE, irradiance_weights, moment_weights, view_directions
from renderer.world.sun import ANGULAR_RADIUS

SOLAR_CONSTANT = 1361.0
"""Irradiance of the sun above the air, in W m-2 (Kopp and Lean 2011)."""

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Weights of red, green and blue in luminance (ITU-R BT.709)."""

NIGHT_RADIANCE = 1.7e-4 / 93.0
"""Radiance of the moonless night sky, in W m-2 sr-1: 22 magnitudes per square second of arc are 1.7e-4 cd m-2 (Leinert
et al. 1998), at sunlight's 93 lm W-1."""

CELLS = (32, 64)
"""Rows and columns of the sky cut into cells of one solid angle, 5.6 degrees wide."""

WITHIN = 8
"""Places along each side of such a cell whose mean it takes."""

STEPS = 40
"""Segments of a view ray, short near the eye."""

SKY_DECLARATIONS = """uniform sampler2D sky_view;      // W m-2 sr-1; columns: azimuth from the sun, rows: elevation
uniform vec3 sky_sun_direction;  // unit vector to the sun
uniform vec3 sky_disc_radiance;  // of the sun's disc, W m-2 sr-1"""
"""What `shaders/lib/sky.glsl` reads: `SkyNow.view` as a float texture (linear filter, clamped) and `sky_uniforms`."""


@dataclass(frozen=True)
class SkyNow:
    """The light of one moment.

    Attributes:
        sun_irradiance: of a plane that faces the sun, (3,) in W m-2.
        sky_irradiance: of a horizontal plane, sun excluded, (3,) in W m-2.
        view: radiance of the sky, (elevations, azimuths, 3) float32 in W m-2 sr-1; row k is at elevation
            (pi/2) (k/(rows-1))^2 and column i at azimuth pi (i/(columns-1))^2 from the sun.
        disc_radiance: of the part of the sun's disc above the horizon, (3,) in W m-2 sr-1.
    """

    sun_irradiance: Floats
    sky_irradiance: Floats
    view: NDArray[np.float32]
    disc_radiance: Floats


def sun_elevations() -> Floats:
    """Sun elevations of the tables, in radians: dense where the disc crosses the horizon, sparse by day."""
    steps = ((-18.0, -6.0, 1.0), (-6.0, -1.0, 0.25), (-1.0, 1.0, 0.05), (1.0, 10.0, 0.5), (10.0, 90.0, 2.5))
    parts = [np.arange(low, high - 0.5 * step, step) for low, high, step in steps]
    return np.radians(np.concatenate([*parts, [90.0]]))


def rayleigh_phase(cosine: Floats) -> Floats:
    """Phase function of molecules, in 1/sr; integral one (Hillaire 2020, section 4)."""
    return 3.0 / (16.0 * np.pi) * (1.0 + cosine**2)


def mie_phase(cosine: Floats, g: float = MIE_ASYMMETRY) -> Floats:
    """Phase function of haze, in 1/sr; integral one (Cornette and Shanks 1992, eq. 9)."""
    scale = 3.0 / (8.0 * np.pi) * (1.0 - g * g) / (2.0 + g * g)
    return scale * (1.0 + cosine**2) / (1.0 + g * g - 2.0 * g * cosine) ** 1.5


def bake_sky(
    arguments: dict[str, Any],
    inputs: Mapping[str, Mapping[str, np.ndarray]],
    progress: Callable[[float, str], None],
) -> dict[str, np.ndarray]:
    """Bake the tables of one atmosphere.

    Args:
        arguments: an `Atmosphere` as a document.
        inputs: none is read.
        progress: called with the fraction done.

    Returns:
        `elevations` (E,) of the sun in radians; `sun_irradiance` and `sky_irradiance` (E, 3); `radiance`
        (E, elevations, azimuths, 3) float32. Units and axes as in `SkyNow`.

    Raises:
        InvalidDocument: arguments that are no atmosphere.
    """
    settings = validate(Atmosphere, arguments)
    progress(0.0, "optical depths and multiple scattering")
    air = atmosphere.breathe(settings, ANGULAR_RADIUS)
    suns = sun_elevations()
    r = GROUND + max(settings.altitude / 1000.0, 1e-3)  # a metre keeps level rays off the ground
    elevations, _ = view_directions()
    radiance = np.empty((len(suns), *VIEW_SHAPE, 3), dtype=np.float32)
    for row, elevation in enumerate(elevations):
        progress(0.1 + 0.9 * row / len(elevations), "radiance of the sky")
        radiance[:, row] = SOLAR_CONSTANT * _view_row(air, r, float(elevation), suns) + NIGHT_RADIANCE
    sky = np.einsum("eyxc,yx->ec", radiance.astype(np.float64), irradiance_weights())
    sun = SOLAR_CONSTANT * _sun_through_air(air, r, suns)
    if settings.weather == "overcast":
        radiance = overcast(suns, sun, sky).astype(np.float32)
        sun, sky = 0.0 * sun, np.einsum("eyxc,yx->ec", radiance.astype(np.float64), irradiance_weights())
    progress(1.0, "sky ready")
    return {"elevations": suns, "sun_irradiance": sun, "sky_irradiance": sky, "radiance": radiance}


def _view_row(air: Air, r: float, elevation: float, suns: Floats) -> Floats:
    """Radiance along one view elevation, per unit of solar irradiance (Hillaire 2020, eq. 1).

    Returns:
        (suns, azimuths, 3) in 1/sr.
    """
    _, azimuths = view_directions()
    mu = math.sin(elevation)
    facing = mu * np.sin(suns)[:, None] + math.cos(elevation) * np.cos(suns)[:, None] * np.cos(azimuths)
    edges = float(atmosphere.to_top(np.array(r), np.array(mu))) * np.linspace(0.0, 1.0, STEPS + 1) ** 2
    t, step = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)[:, None]
    here = np.sqrt(r * r + t * t + 2.0 * r * mu * t)
    rayleigh, mie, extinction = atmosphere.coefficients(here - GROUND, air.haze)
    depth = np.cumsum(extinction * step, axis=0)
    lost = np.exp(-np.minimum(extinction * step, atmosphere.DARKEST))
    reach = np.exp(-np.minimum(depth - extinction * step, atmosphere.DARKEST)) * (1.0 - lost) / extinction
    sun = np.clip((r * np.sin(suns)[None, :, None] + t[:, None, None] * facing) / here[:, None, None], -1.0, 1.0)
    place = np.broadcast_to(here[:, None, None], sun.shape)
    beam = atmosphere.transmittance(air, place, sun) * atmosphere.shadow(place, sun, ANGULAR_RADIUS)[..., None]
    once = [np.einsum("kc,keac->eac", reach * sigma, beam) for sigma in (rayleigh, mie)]
    often = np.einsum("kc,keac->eac", reach * (rayleigh + mie), atmosphere.glow(air, place, sun))
    return once[0] * rayleigh_phase(facing)[..., None] + once[1] * mie_phase(facing)[..., None] + often


def _sun_through_air(air: Air, r: float, suns: Floats) -> Floats:
    """Mean transmittance over the sun's disc, the part below the horizon dark, (suns, 3).

    The disc is cut in 200 level strips of uniform radiance; the horizon is level, whatever the altitude.
    """
    y = (np.arange(200) + 0.5) / 100.0 - 1.0
    weight = np.sqrt(1.0 - y * y)
    heights = suns[:, None] + ANGULAR_RADIUS * y
    through = atmosphere.transmittance(air, np.full_like(heights, r), np.sin(np.maximum(heights, 0.0)))
    return np.einsum("eyc,ey->ec", through, (heights > 0.0) * weight / weight.sum())


def visible_share(elevation: float) -> float:
    """Share of the sun's disc above a level horizon, its centre at `elevation` in radians."""
    x = min(1.0, max(-1.0, elevation / ANGULAR_RADIUS))
    return 0.5 + (x * math.sqrt(1.0 - x * x) + math.asin(x)) / math.pi


def sky_for(tables: Mapping[str, np.ndarray], elevation: float) -> SkyNow:
    """The light of one sun.

    Radiance is interpolated geometrically, because at twilight it falls by a factor from one table entry to the next;
    the irradiance of the sky is the integral of just that picture.

    Args:
        tables: from `bake_sky`.
        elevation: of the sun, in radians; below -18 degrees it is night and nothing changes any more.
    """
    suns = tables["elevations"]
    e = float(np.clip(elevation, suns[0], suns[-1]))
    k = int(np.clip(np.searchsorted(suns, e, side="right") - 1, 0, len(suns) - 2))
    w = (e - float(suns[k])) / float(suns[k + 1] - suns[k])
    low, high = tables["radiance"][k].astype(np.float64), tables["radiance"][k + 1].astype(np.float64)
    view = np.exp((1.0 - w) * np.log(low) + w * np.log(high))
    sun = (1.0 - w) * tables["sun_irradiance"][k] + w * tables["sun_irradiance"][k + 1]
    share = visible_share(e)
    disc = sun / (math.pi * ANGULAR_RADIUS**2 * share) if share > 1e-3 else np.zeros(3)
    return SkyNow(sun, np.einsum("yxc,yx->c", view, irradiance_weights()), view.astype(np.float32), disc)


def metered_light(tables: Mapping[str, np.ndarray], elevation: float) -> float:
    """How much light falls on level ground from sun and sky together, its colours weighed as in Rec. 709, in W m-2.

    Args:
        tables: from `bake_sky`.
        elevation: of the sun, in radians.
    """
    suns = tables["elevations"]
    sun = LUMINANCE @ [np.interp(elevation, suns, column) for column in tables["sun_irradiance"].T]
    sky = LUMINANCE @ np.exp([np.interp(elevation, suns, column) for column in np.log(tables["sky_irradiance"]).T])
    return float(max(math.sin(elevation), 0.0) * sun + sky)


def sky_moments(now: SkyNow) -> dict[str, Floats]:
    """Integrals of the sky's radiance over the upper hemisphere, times powers of the direction, (3,) in W m-2 each."""
    found = moment_weights() @ now.view.reshape(-1, 3).astype(np.float64)
    return dict(zip(MOMENTS, found, strict=True))


def sky_uniforms(now: SkyNow, sun_direction: Floats) -> dict[str, tuple[float, float, float]]:
    """Values of `SKY_DECLARATIONS`, its texture aside."""
    values = {"sky_sun_direction": sun_direction, "sky_disc_radiance": now.disc_radiance, **sky_moments(now)}
    return {name: (float(v[0]), float(v[1]), float(v[2])) for name, v in values.items()}


def sky_radiance(now: SkyNow, sun_direction: Floats, directions: Floats) -> Floats:
    """Radiance of the sky without the sun's disc, in W m-2 sr-1: twin of `sky_radiance` in `shaders/lib/sky.glsl`.

    Args:
        now: the light.
        sun_direction: unit vector to the sun, (3,).
        directions: unit vectors, (..., 3).
    """
    rows, columns = VIEW_SHAPE
    flat = np.linalg.norm(directions[..., :2], axis=-1) * float(np.linalg.norm(sun_direction[:2]))
    cosine = (directions[..., :2] @ sun_direction[:2]) / np.maximum(flat, 1e-6)
    azimuth = np.arccos(np.clip(cosine, -1.0, 1.0))
    y = np.sqrt(np.arcsin(np.clip(directions[..., 2], 0.0, 1.0)) / (0.5 * np.pi)) * (rows - 1)
    x = np.sqrt(azimuth / np.pi) * (columns - 1)
    return atmosphere.bilinear(now.view.astype(np.float64), y, x)


def sky_cells(now: SkyNow, sun_direction: Floats) -> Floats:
    """Mean radiance of the sky in cells of one solid angle, without the sun's disc.

    Args:
        now, sun_direction: as in `sky_radiance`.

    Returns:
        (rows, columns, 3) of `CELLS`, W m-2 sr-1: rows are equal steps in the sine of the elevation from the horizon
        up, columns equal steps in azimuth clockwise from north.
    """
    rows, columns = (count * WITHIN for count in CELLS)
    sine = ((np.arange(rows) + 0.5) / rows)[:, None]
    azimuth = (np.arange(columns) + 0.5) / columns * 2.0 * np.pi
    level = np.sqrt(1.0 - sine * sine)
    directions = np.stack(np.broadcast_arrays(level * np.sin(azimuth), level * np.cos(azimuth), sine), axis=-1)
    fine = sky_radiance(now, sun_direction, directions)
    found: Floats = fine.reshape(CELLS[0], WITHIN, CELLS[1], WITHIN, 3).mean(axis=(1, 3))
    return found


def sky_sun_disc(now: SkyNow, sun_direction: Floats, directions: Floats) -> Floats:
    """Radiance of the sun's disc above the horizon, in W m-2 sr-1: twin of `sky_sun_disc` in `shaders/lib/sky.glsl`.

    Args:
        now, sun_direction, directions: as in `sky_radiance`.
    """
    chord = 2.0 * math.sin(0.5 * ANGULAR_RADIUS)
    inside = (np.linalg.norm(directions - sun_direction, axis=-1) < chord) & (directions[..., 2] > 0.0)
    return np.where(inside[..., None], now.disc_radiance, 0.0)
