"""What a sun study found: maps of hours and energy, as arrays, GeoTIFF and pictures."""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from PIL import Image

from renderer.world.sun_course import Place, SunlightPeriod
from renderer.world.terrain import Terrain
from renderer.world.terrain_geotiff import save_geotiff


@dataclass(frozen=True)
class SunStudy:
    """What a study found.

    Attributes:
        hours: of direct sun, (rows, columns) float32, h; NaN, as in the other maps, under trees.
        insolation: by beam and sky on the ground's slope, kWh m-2; `diffuse` is the sky's part of it.
        sky: share of an even sky's light that arrives, in [0, 1].
        terrain: whose nodes these are.
        meta: arguments, place, units, what was assumed.
    """

    UNITS: ClassVar[Mapping[str, str]] = {"hours": "h", "insolation": "kWh m-2", "diffuse": "kWh m-2", "sky": "ratio"}

    hours: np.ndarray
    insolation: np.ndarray
    diffuse: np.ndarray
    sky: np.ndarray
    terrain: Terrain
    meta: Mapping[str, Any]

    @property
    def arrays(self) -> dict[str, np.ndarray]:
        """Every map by its name."""
        return {name: getattr(self, name) for name in self.UNITS}

    def geotiff(self, name: str) -> bytes:
        """A map as GeoTIFF in the terrain's own coordinate system."""
        buffer = io.BytesIO()
        save_geotiff(buffer, self.arrays[name], self.terrain)
        return buffer.getvalue()

    def picture(self, name: str) -> bytes:
        """A map as PNG, one pixel a node, in the colours of `scale`; transparent where there is no value."""
        values = self.arrays[name]
        low, high, _ = self.scale(name)
        known = np.isfinite(values)
        part = np.clip((np.where(known, values, low) - low) / max(high - low, 1e-9), 0, 1)
        pixels = np.dstack([_colours()[np.rint(part * 255).astype(int)], known.astype(np.uint8) * 255])
        buffer = io.BytesIO()
        Image.fromarray(pixels, "RGBA").save(buffer, "png")
        return buffer.getvalue()

    def scale(self, name: str) -> tuple[float, float, list[str]]:
        """What the darkest and the brightest colour stand for, and some colours between, as `#rrggbb`."""
        values = self.arrays[name]
        colours = ["#" + bytes(colour).hex() for colour in _colours()[:: 255 // 5]]
        return float(np.nanmin(values)), float(np.nanmax(values)), colours

    @property
    def numbers(self) -> dict[str, Any]:
        """Range, mean and unit of each map, and `meta`, as JSON."""
        found: dict[str, Any] = {}
        for name, unit in self.UNITS.items():
            low, high, colours = self.scale(name)
            mean = float(np.nanmean(self.arrays[name], dtype=np.float64))
            found[name] = {"unit": unit, "lowest": low, "mean": mean, "highest": high, "colours": colours}
        return {**found, "meta": dict(self.meta)}


def _colours() -> np.ndarray:
    """256 colours of even steps in lightness, (256, 3) uint8: dark, purple, orange, yellow."""
    from matplotlib import colormaps  # half a second to import

    shades: np.ndarray = np.rint(colormaps["inferno"](np.arange(256))[:, :3] * 255).astype(np.uint8)
    return shades


def meta_of(period: SunlightPeriod, place: Place, plain_hours: float, terrain: Terrain, wooded: bool) -> dict[str, Any]:
    """What a study's numbers mean and assume, as JSON.

    Args:
        period, place: what was studied, where.
        plain_hours: hours of sun on a plain, h.
        terrain: the land's ground. wooded: whether trees stand on it.
    """
    return {
        "arguments": period.model_dump(mode="json"),
        "units": dict(SunStudy.UNITS),
        "place": {"latitude": place.latitude, "longitude": place.longitude, "altitudes_m": list(place.altitudes)},
        "hours_on_a_plain": plain_hours,
        "cell_size_m": list(terrain.cell_size),
        "shape": list(terrain.elevation.shape),
        "size_m": [cell * count for cell, count in zip(terrain.cell_size, terrain.elevation.shape[::-1], strict=True)],
        "technique": "horizon of every node along each degree of azimuth, the range's suns counted above it",
        "source": "Dozier and Frew 1990 (sky); Reda and Andreas 2004 (sun); Ineichen and Perez 2002 (clear sky)",
        "estimated_error": {"hours": "0.1 % of a year, 1 % of a month in a steep hollow"},
        "notes": [
            "cloudless sky, evenly bright; no light from the ground",
            "the sun counts by its centre, refracted; flat Earth, level land beyond the edge",
            *(["trees let nothing through; no value on the ground under them"] if wooded else []),
            *terrain.notes,
        ],
    }
