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
from renderer.clouds.phase_tables import table_cosines
from renderer.clouds.slab_axes import cosines, depths
from renderer.core.technique import Arrays

Progress = Callable[[float, str], None]

NODES = 16
"""Gauss nodes a side: the moment 32 is cut off as a peak. Fluxes then err by 3e-4 at most, at grazing sun."""

ORDERS = 9
"""Azimuthal orders of the light of orders 2 and more."""

GLOW_PATHS = 33
"""Optical paths in the table of the glow: even steps of the logarithm between GLOW_LEAST and GLOW_MOST."""

GLOW_LEAST, GLOW_MOST = -4.0, 6.0
"""Powers of two."""

GLOW_ANGLES = 512
"""Angles of that table, of the forward hemisphere alone."""


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
        `up`, `down` (T, K, K, 3): order 0 of azimuth in each band over `second_share` or `down_share`, by optical
        depth, cosine of the sun, cosine of the view. `up_turns`, `down_turns` (2, T, K, K, 4): orders 1 to 8, mean of
        the bands. `flux` (T, K, 3): hemispherical reflectance over that of the simplest layer, `plain_reflectance`.
        `even` (T, 3): the same for even light. `peak` (3,). `rest` (TABLE, 3), `glow` (GLOW_PATHS, GLOW_ANGLES, 3):
        see `_glow`.
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
    share = {"up": second_share(deep, mu, mu[:, None]), "down": down_share(deep, mu, mu[:, None])}
    arrays: dict[str, np.ndarray] = {}
    for side, scale in share.items():
        # From (T, M, view, sun) to (T, sun, view, M).
        turned = np.stack([np.moveaxis(one[side], (1, 2, 3), (3, 2, 1)) for one in found]) / scale[..., None]
        arrays[side] = np.moveaxis(turned[..., 0], 0, -1) / (2 * np.pi)
        turns = turned.mean(axis=0)[..., 1:] / np.pi
        arrays[f"{side}_turns"] = np.stack([turns[..., :4], turns[..., 4:]])
    arrays["flux"] = np.stack([one["flux"] for one in found], axis=-1) / plain_reflectance(tau[:, None], mu)[..., None]
    even = np.stack([one["even"] for one in found], axis=-1)
    arrays["even"] = even / even_plain(tau)[:, None]
    arrays["peak"] = np.array([one.peak for one in streams])
    return {**{name: np.asarray(a, np.float32) for name, a in arrays.items()}, **_glow(inputs["phase"], arrays["peak"])}


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
        "up": np.stack([(a.reflection - b.reflection)[wanted] for a, b in zip(layers, once)]),
        "down": np.stack([(a.transmission - b.transmission)[wanted] for a, b in zip(layers, once)]),
        "flux": np.stack([streams.hemispherical(layer.reflection) for layer in layers]),
        # Even light of radiance 1 / pi: the mean over its directions, weighted by their cosine.
        "even": np.array([2 * weight @ layer.reflection[0][node, node] @ streams.weight[node] for layer in layers]),
    }


def _glow(phase: Arrays, peak: np.ndarray) -> dict[str, np.ndarray]:
    """Two deflections and more by the forward peak alone, and what the peak leaves of the phase function.

    The peak is what delta-M takes out: moments f up to its cut, those of the phase function beyond. Along a path of
    optical depth t the spectrum of n deflections and more is Poisson's (formulas a3).

    Returns:
        `rest` (TABLE, 3), 1/sr; `glow` (GLOW_PATHS, GLOW_ANGLES, 3), 1/sr, over its energy e^(-t) (e^(f t) - 1 - f t).
    """
    moments = phase["moments"]
    degrees = np.arange(moments.shape[1])
    kept = np.where(degrees < 2 * NODES, peak[:, None], moments)
    angles = table_cosines(2 * GLOW_ANGLES)[:GLOW_ANGLES]
    glow = np.zeros((GLOW_PATHS, GLOW_ANGLES, 3))
    rest = np.stack([values_of(band, table_cosines()) for band in moments - kept], axis=1)
    for row, path in enumerate(glow_paths()):
        for band, (share, f) in enumerate(zip(kept, peak)):
            if f > 0:
                spectrum = twice_or_more(share * path) / twice_or_more(f * path)
                glow[row, :, band] = values_of(spectrum * phase["disc"], angles)
    return {"rest": rest.astype(np.float32), "glow": np.maximum(glow, 0).astype(np.float32)}


def twice_or_more(x: np.ndarray | float) -> np.ndarray:
    """e^x - 1 - x, exact for small x."""
    x = np.asarray(x, np.float64)
    small = np.where(np.abs(x) < 0.1, x, 0.0)
    series = small**2 / 2 * (1 + small / 3 * (1 + small / 4 * (1 + small / 5 * (1 + small / 6 * (1 + small / 7)))))
    return np.where(np.abs(x) < 0.1, series, np.expm1(np.minimum(x, 600)) - x)
