"""The air's tables as textures, and the light of sun and sky anywhere on the planet."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from renderer.core.params import validate
from renderer.world import atmosphere
from renderer.world.atmosphere import Atmosphere
from renderer.world.sky import SOLAR_CONSTANT, sky_for
from renderer.world.sun import ANGULAR_RADIUS

SKYLIGHT_TEXELS = 256

BEAM = (64, 256)
"""Heights and directions of the table of sunlight."""

MARGIN = 0.01
"""How far below the horizon it goes on, where the sun's disc is still half up; AIR_MARGIN of
shaders/clouds/air.glsl."""


def bake_air(
    arguments: dict[str, Any],
    inputs: Mapping[str, Mapping[str, np.ndarray]],
    progress: Callable[[float, str], None],
) -> dict[str, np.ndarray]:
    """Tables of one atmosphere.

    Args:
        arguments: an `Atmosphere` as a document.

    Returns:
        `beam` (heights, directions, 3), share of the sun's light that arrives: row j at the height 100 km (j/63)^2,
        column i where the zenith cosine is c = (1 + MARGIN) (i/255)^2 - MARGIN of the way from the horizon's to 1;
        `glow` (heights, suns, 3), radiance of light scattered twice or more, W m-2 sr-1, axes as in
        `renderer.world.atmosphere`; float32.
    """
    progress(0.0, "optical depths and multiple scattering")
    air = atmosphere.breathe(validate(Atmosphere, arguments), ANGULAR_RADIUS)
    progress(1.0, "air ready")
    return {"beam": _beam(air).astype(np.float32), "glow": (SOLAR_CONSTANT * air.glow).astype(np.float32)}


def _beam(air: atmosphere.Air) -> np.ndarray:
    """The table `beam` of an atmosphere."""
    rows, columns = BEAM
    r = atmosphere.GROUND + (atmosphere.TOP - atmosphere.GROUND) * (np.arange(rows)[:, None] / (rows - 1)) ** 2
    dip = np.sqrt((r - atmosphere.GROUND) * (r + atmosphere.GROUND)) / r
    above = (1.0 + MARGIN) * (np.arange(columns) / (columns - 1)) ** 2 - MARGIN
    mu = np.clip(above * (1.0 + dip) - dip, -1.0, 1.0)
    r = np.broadcast_to(np.minimum(r, atmosphere.TOP - 1e-6), mu.shape)
    through = atmosphere.transmittance(air, r, np.maximum(mu, -dip))
    return np.asarray(through * atmosphere.shadow(r, mu, ANGULAR_RADIUS)[..., None])


def skylight(tables: Mapping[str, np.ndarray]) -> np.ndarray:
    """Irradiance of level ground by the sky, (1, 256, 3) W m-2: column i at the sun's elevation e with
    sqrt(|e| / (pi/2)) sign(e) = 2 i / 255 - 1, so that twilight has room.

    Args:
        tables: of `renderer.world.sky.bake_sky`.
    """
    x = np.linspace(-1.0, 1.0, SKYLIGHT_TEXELS)
    elevations = np.sign(x) * x * x * np.pi / 2
    return np.array([[sky_for(tables, float(e)).sky_irradiance for e in elevations]], dtype=np.float32)
