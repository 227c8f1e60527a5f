"""Where the layer is thick and where it is thin: fields that are drawn once, and the map that they make at a moment.

A map holds the thickness as a share of the layer's own: 1 in the mean of a closed layer, 0 where the sky is open. Two
fields of the same statistics turn into each other, f(t) = A cos(w t) + B sin(w t): clouds come and go, and their
cover stays.

Stratus is noise with a power spectrum k^-3 to k^-4 (Cahalan and Snider 1989 measured k^-3.3 in two dimensions for
stratocumulus' liquid water); stratocumulus has closed cells besides, the distances to scattered points (Worley 1996).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from scipy.spatial import cKDTree
from scipy.special import erfinv

from renderer.clouds import weather
from renderer.clouds.world_scale import CLOUD_NODES
from renderer.core.cache import AssetStore
from renderer.core.errors import InputError
from renderer.core.technique import Arrays
from renderer.world.maps import load_map, spread

SLOPE = 3.3
"""Exponent of the power spectrum in two dimensions (Cahalan and Snider 1989: k^-5/3 to k^-3.6 along a line)."""

THICKEST = 8.0
"""Largest thickness of a user's map, as a share of the layer's."""

EDGE = 0.3
"""Over how many standard deviations of the field a cloud gains its thickness."""

SWELLS = 2.5
"""Standard deviations of the field at which a cloud grows no thicker: the shell that a ray must search stays thin."""

LIFETIME = 3600.0
"""Time in which the clouds of a place have become others, s."""


def bake_fields(arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]) -> Arrays:
    """The fields of a procedural map, or the user's own map.

    Args:
        arguments: the document's `clouds`.

    Returns:
        `fields` (2, N, N) float32 of mean 0 and variance 1, both periodic, or (1, N, N) for a user's map;
        `systems` (M, 2 M) float32 in [0, 1], the cover of the weather systems by latitude and longitude, or (4, 4)
        ones; `reach` (), the greatest value of a user's map.
    """
    kind = arguments["kind"]
    progress(0.1, "drawing the clouds")
    everywhere = np.ones((4, 4), np.float32)
    if kind == "uniform":
        return {"fields": np.zeros((1, 4, 4), np.float32), "systems": everywhere, "reach": np.array(0.0)}
    if kind == "asset":
        own = _own(arguments)
        return {"fields": own, "systems": everywhere, "reach": np.array(float(own.max()))}
    rng = np.random.Generator(np.random.PCG64(arguments["seed"]))
    fields = np.stack([_field(rng, arguments) for _ in range(2)])
    progress(0.7, "drawing the weather systems")
    systems = weather.systems(rng) if arguments["systems"] else everywhere
    return {"fields": fields.astype(np.float32), "systems": systems, "reach": np.array(0.0)}


def _own(arguments: dict[str, Any]) -> np.ndarray:
    """The user's map, (1, N, N), row 0 its southern edge."""
    try:
        values, full = load_map(AssetStore().get(arguments["asset"].removeprefix("asset:")).path, "thickness")
    except InputError as failure:
        raise failure.at("clouds.asset") from None
    full = arguments["full"] or full
    return spread(np.clip(values / full, 0.0, THICKEST), CLOUD_NODES)[None, ::-1].astype(np.float32)


def _field(rng: np.random.Generator, arguments: dict[str, Any]) -> np.ndarray:
    """One periodic field of mean 0 and variance 1, (N, N)."""
    texels = CLOUD_NODES
    longest = texels * arguments["cell_size"] / arguments["side"]
    noise = _power_noise(rng, texels, SLOPE, longest * 4.0)
    if arguments["style"] == "stratus":
        return noise
    count = max(4, round((arguments["side"] / arguments["cell_size"]) ** 2))
    detail = _power_noise(rng, texels, 2.6, longest)
    return _normal(0.65 * _normal(_cells(rng, texels, count, longest)) + 0.45 * noise + 0.6 * detail)


def _power_noise(rng: np.random.Generator, texels: int, slope: float, longest: float) -> np.ndarray:
    """Gaussian noise of spectrum k^-slope, flat beyond `longest` texels; mean 0, variance 1, periodic."""
    k = np.hypot(np.fft.fftfreq(texels)[:, None], np.fft.rfftfreq(texels)[None, :])
    spectrum = np.fft.rfft2(rng.standard_normal((texels, texels))) / (k**2 + longest**-2.0) ** (slope / 4)
    spectrum[0, 0] = 0.0
    field = np.fft.irfft2(spectrum, (texels, texels))
    return field / field.std()


def _cells(rng: np.random.Generator, texels: int, count: int, size: float) -> np.ndarray:
    """How far inside a closed cell each texel lies, (N, N): less its distance to the nearest of `count` points, on a
    ground that noise as large as a cell, `size` texels, has bent."""
    tree = cKDTree(rng.random((count, 2)), boxsize=1.0)
    grid = (np.arange(texels) + 0.5) / texels
    bend = np.stack([_power_noise(rng, texels, 3.6, size) for _ in range(2)], axis=-1)
    places = np.stack(np.meshgrid(grid, grid, indexing="ij"), axis=-1) + 0.22 * size / texels * bend
    near: np.ndarray = tree.query(places.reshape(-1, 2) % 1.0)[0]
    return -near.reshape(texels, texels)


def _normal(field: np.ndarray) -> np.ndarray:
    """The field with its values spread as a normal distribution's, in their order."""
    ranks = np.argsort(np.argsort(field, axis=None)).reshape(field.shape)
    return math.sqrt(2.0) * erfinv(2.0 * (ranks + 0.5) / field.size - 1.0)


def thickness_map(clouds: Any, baked: Mapping[str, np.ndarray], time: float) -> np.ndarray:
    """Thickness at a moment as a share of the layer's, (N, N) float32, row 0 at the south.

    Between clouds it goes on below zero: whoever reads between texels cuts there, and edges are smooth lines.

    Args:
        clouds: the document's map. baked: of `bake_fields`. time: s.
    """
    fields = baked["fields"]
    if clouds.kind == "uniform":
        return np.ones((4, 4), np.float32)
    if clouds.kind == "asset":
        return np.asarray(fields[0])
    now, later = turned(clouds, time)
    return _thickness(clouds, fields[0] * now + fields[1] * later).astype(np.float32)


def turned(clouds: Any, time: float) -> tuple[float, float]:
    """Shares of the two fields at a moment [s]."""
    if clouds.kind != "procedural":
        return 1.0, 0.0
    turn = 2.0 * math.pi * time * clouds.evolution / LIFETIME / 4.0
    return math.cos(turn), math.sin(turn)


def threshold_of(clouds: Any) -> float:
    """Standard deviations of the field above which its clouds stand."""
    return math.sqrt(2.0) * float(erfinv(np.clip(1.0 - 2.0 * clouds.cover, -0.9999999, 0.9999999)))


def _thickness(clouds: Any, field: np.ndarray) -> np.ndarray:
    """Thickness where the field has some value, as a share of the layer's."""
    # The cover's share of a normal distribution lies above the threshold; edges rise softly, and tops vary.
    above = (field - threshold_of(clouds)) / EDGE
    rise = np.where(above > 0.0, -np.expm1(-np.abs(above)), np.expm1(-np.abs(above)))
    swell = SWELLS * np.tanh(field / SWELLS)
    return np.asarray(rise * np.exp(clouds.variation * swell - 0.5 * clouds.variation**2))


CURVE = 4096
"""Entries of the thickness as a curve: it then errs by 2e-5 of the layer's at most."""

FIELD = 8.0
"""Standard deviations of the field that the curve covers on either side."""


def thickness_curve(clouds: Any) -> tuple[np.ndarray, float, float]:
    """The same as a table (M,) float32 by the fields' sum, the value of its first entry, and entries for each unit."""
    if clouds.kind != "procedural":
        return np.array([0.0, THICKEST], np.float32), 0.0, 1.0 / THICKEST
    field = np.linspace(-FIELD, FIELD, CURVE + 1)
    return _thickness(clouds, field).astype(np.float32), -FIELD, CURVE / (2 * FIELD)


def highest(clouds: Any, baked: Mapping[str, np.ndarray]) -> float:
    """A bound of the thickness map at every moment, as a share of the layer's thickness."""
    if clouds.kind == "uniform":
        return 1.0
    if clouds.kind == "asset":
        return float(baked["reach"])
    return math.exp(clouds.variation * SWELLS - 0.5 * clouds.variation**2)
