"""What scattering techniques bake: light of two orders and more by doubling, the glow of the forward peak.

What is stored varies slowly: radiances are over `second_share`, which carries their dependence on thin layers and
grazing directions, and fluxes over those of the simplest layer.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from renderer.clouds.doubling import Streams
from renderer.clouds.peak import factors
from renderer.clouds.slab_axes import cosines, depths
from renderer.core.technique import Arrays

Progress = Callable[[float, str], None]

NODES = 16
"""Gauss nodes a side: the moment 32 is cut off as a peak. Fluxes then err by 3e-4 at most, at grazing sun."""

ORDERS = 9
"""Azimuthal orders of the light of orders 2 and more."""


def second_share(depth: np.ndarray, view: np.ndarray, sun: np.ndarray) -> np.ndarray:
    """How light of two orders and more goes with a thin layer and with grazing directions, without unit."""
    a = depth * (1 / view + 1 / sun)
    # 1 - (1 + a) e^(-a) loses all its digits in a thin layer; this has the same limits at both ends.
    return sun / (sun + view) * (a / (1 + a)) ** 2


def down_share(depth: np.ndarray, view: np.ndarray, sun: np.ndarray) -> np.ndarray:
    """The same for light that leaves below: thick layers let through ever less."""
    return second_share(depth, view, sun) / (1 + 0.1 * depth)


def bake_doubling(arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Progress) -> Arrays:
    """Bake what `adding_doubling` reads.

    Returns:
        `mean` (2, T, K, K, 3): order 0 of azimuth in each band of the light that leaves on the sunlit side and on the
        other, over `second_share` and `down_share`, by optical depth, cosine of the sun, cosine of the view. `low`,
        `high` (2, T, K, K, 4): orders 1 to 4 and 5 to 8, mean of the bands. `flux` (T, K, 3): hemispherical reflectance
        over that of the simplest layer, `plain_reflectance`; `even` (T, 3): the same for even light. `peak` (3,).
        `glow` (GLOW_PATHS, TABLE, 3): see `peak.factors`.
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
    arrays["glow"] = factors(inputs["phase"], arrays["peak"], 2 * NODES)
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
