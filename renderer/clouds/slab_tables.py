"""What scattering techniques bake: light of two orders and more by doubling, the glow of the forward peak.

What is stored varies slowly: radiances are over `second_share`, which carries their dependence on thin layers and
grazing directions, and fluxes over those of the simplest layer.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from renderer.clouds.doubling import Streams
from renderer.clouds.legendre import values_of
from renderer.clouds.phase_tables import TABLE, table_cosines
from renderer.clouds.slab_axes import cosines, depths
from renderer.core.technique import Arrays

Progress = Callable[[float, str], None]

NODES = 16
"""Gauss nodes a side: the moment 32 is cut off as a peak. Fluxes then err by 3e-4 at most, at grazing sun."""

ORDERS = 9
"""Azimuthal orders of the light of orders 2 and more."""

GLOW_PATHS = 21
"""Optical paths in the table of the glow: even steps of the logarithm between GLOW_LEAST and GLOW_MOST."""

GLOW_LEAST, GLOW_MOST = -4.0, 6.0
"""Powers of two."""

GLOW_ANGLES = TABLE // 2
"""Angles of that table: those of the phase function's in the forward hemisphere."""


def second_share(depth: np.ndarray, view: np.ndarray, sun: np.ndarray) -> np.ndarray:
    """How light of two orders and more goes with a thin layer and with grazing directions, without unit."""
    a = depth * (1 / view + 1 / sun)
    # 1 - (1 + a) e^(-a) loses all its digits in a thin layer; this has the same limits at both ends.
    return sun / (sun + view) * (a / (1 + a)) ** 2


def down_share(depth: np.ndarray, view: np.ndarray, sun: np.ndarray) -> np.ndarray:
    """The same for light that leaves below: thick layers let through ever less."""
    return second_share(depth, view, sun) / (1 + 0.1 * depth)


def glow_paths() -> np.ndarray:
    """Optical paths of the table of the glow."""
    return 2.0 ** np.linspace(GLOW_LEAST, GLOW_MOST, GLOW_PATHS)


def bake_doubling(arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Progress) -> Arrays:
    """Bake what `adding_doubling` reads.

    Returns:
        `mean` (2, T, K, K, 3): order 0 of azimuth in each band of the light that leaves on the sunlit side and on the
        other, over `second_share` and `down_share`, by optical depth, cosine of the sun, cosine of the view. `low`,
        `high` (2, T, K, K, 4): orders 1 to 4 and 5 to 8, mean of the bands. `flux` (T, K, 3): hemispherical reflectance
        over that of the simplest layer, `plain_reflectance`; `even` (T, 3): the same for even light. `peak` (3,).
        `glow` (GLOW_PATHS, GLOW_ANGLES, 3): see `_glow`.
    """
    moments = inputs["phase"]["moments"]
    mu, tau = cosines(), depths()
    streams: list[Streams] = []
    found: list[dict[str, np.ndarray]] = []
    for number, band in enumerate(moments):
        progress(number / len(moments), "light scattered twice and more")
        if number and np.array_equal(band, moments[number - 1]):
            streams.append(streams[-1])
            found.append(found[-1])
            continue
        streams.append(Streams(band, mu, NODES, ORDERS))
        found.append(_band(streams[-1], tau))
    deep = tau[:, None, None]
    share = np.stack([second_share(deep, mu, mu[:, None]), down_share(deep, mu, mu[:, None])])
    # From (band, side, T, M, view, sun) to (band, side, T, sun, view, M).
    turned = np.moveaxis(np.stack([one["leaving"] for one in found]), (3, 4, 5), (5, 4, 3)) / share[..., None]
    turns = turned.mean(axis=0)[..., 1:] / np.pi
    arrays = {"mean": np.moveaxis(turned[..., 0], 0, -1) / (2 * np.pi), "low": turns[..., :4], "high": turns[..., 4:]}
    arrays["flux"] = np.stack([one["flux"] for one in found], axis=-1) / plain_reflectance(tau[:, None], mu)[..., None]
    even = np.stack([one["even"] for one in found], axis=-1)
    arrays["even"] = even / even_plain(tau)[:, None]
    arrays["peak"] = np.array([one.peak for one in streams])
    arrays["glow"] = _glow(inputs["phase"], arrays["peak"])
    return {name: np.asarray(array, np.float32) for name, array in arrays.items()}


def plain_reflectance(depth: np.ndarray, mu: np.ndarray) -> np.ndarray:
    """A reflectance of the right limits, by which tables are divided: proportional to thin layers, 1 for thick ones."""
    return depth / (depth + 7 * mu)


def even_plain(depth: np.ndarray) -> np.ndarray:
    """The same for even light."""
    return depth / (depth + 7)


def _band(streams: Streams, tau: np.ndarray) -> dict[str, np.ndarray]:
    """Orders 2 and more of one band, and its fluxes."""
    layers = streams.layers(tau)
    wanted = (slice(None), streams.wanted, streams.wanted)
    once = [streams.single(layer.depth) for layer in layers]
    node = slice(0, streams.wanted.start)
    weight = (streams.weight * streams.mu)[node]
    return {
        "leaving": np.stack(
            [
                [(a.reflection - b.reflection)[wanted] for a, b in zip(layers, once)],
                [(a.transmission - b.transmission)[wanted] for a, b in zip(layers, once)],
            ]
        ),
        "flux": np.stack([streams.hemispherical(layer.reflection) for layer in layers]),
        # Even light of radiance 1 / pi: the mean over its directions, weighted by their cosine.
        "even": np.array([2 * weight @ layer.reflection[0][node, node] @ streams.weight[node] for layer in layers]),
    }


def _glow(phase: Arrays, peak: np.ndarray) -> np.ndarray:
    """How light around the sun differs from order 1 of the scaled layer with the true phase function, as a factor.

    The peak p is what delta-M takes out: moments f up to its cut, those of the phase function beyond. Along a path of
    optical depth t, order 1 is P t e^(-t); what the peak leaves of P goes through the scaled layer, (P - f p) t
    (e^(-(1 - f) t) - e^-t); and n deflections by the peak alone, two and more, are Poisson's: the spectrum e^-t (e^(f
    p_l t) - 1 - f p_l t) (formulas a3). Their sum is divided by P t e^(-(1 - f) t). Behind the sun's hemisphere it is
    1.

    Returns:
        (GLOW_PATHS, GLOW_ANGLES, 3).
    """
    moments = phase["moments"]
    kept = np.where(np.arange(moments.shape[1]) < 2 * NODES, peak[:, None], moments)
    cosines_ahead = table_cosines()[:GLOW_ANGLES]
    factor = np.ones((GLOW_PATHS, GLOW_ANGLES, 3))
    for band, (share, f) in enumerate(zip(kept, peak)):
        once = np.maximum(values_of(moments[band] * phase["disc"], cosines_ahead), 1e-9)
        rest = values_of((moments[band] - share) * phase["disc"], cosines_ahead)
        for row, t in enumerate(glow_paths()):
            # Over t e^(-(1 - f) t) all three terms are of moderate size.
            alone = values_of(np.exp(-f * t) / t * twice_or_more(share * t) * phase["disc"], cosines_ahead)
            factor[row, :, band] = np.exp(-f * t) + (rest * -np.expm1(-f * t) + alone) / once
    return np.maximum(factor, 0)


def twice_or_more(x: np.ndarray | float) -> np.ndarray:
    """e^x - 1 - x, exact for small x."""
    x = np.asarray(x, np.float64)
    small = np.where(np.abs(x) < 0.1, x, 0.0)
    series = small**2 / 2 * (1 + small / 3 * (1 + small / 4 * (1 + small / 5 * (1 + small / 6 * (1 + small / 7)))))
    return np.where(np.abs(x) < 0.1, series, np.expm1(np.minimum(x, 600)) - x)
