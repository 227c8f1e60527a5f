"""The light of plane layers at chosen directions, by doubling with no table between: what `measure slab` calls
`doubling`.

Orders 1 and the forward peak's are exact in the angle, as the technique `adding_doubling` has them (`peak`);
all that is left is followed in as many azimuthal orders as there are moments after delta-M.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from renderer.clouds.doubling import Streams
from renderer.clouds.legendre import values_of
from renderer.clouds.peak import escaping, parts, transmitted_spectrum
from renderer.clouds.slab import Slab, first_down, first_up

Progress = Callable[[float, str], None]

NODES = 32
"""Gauss nodes a side."""


def solve(
    moments: np.ndarray,
    albedo: float,
    depths: np.ndarray,
    suns: np.ndarray,
    views: np.ndarray,
    azimuths: np.ndarray,
    nodes: int = NODES,
    progress: Progress = lambda share, words: None,
) -> dict[str, np.ndarray]:
    """Reflected and transmitted light of one band.

    Args:
        moments: (L,) of the phase function. albedo: of single scattering.
        depths: (T,) optical depths. suns, views: (S,), (V,) cosines. azimuths: (A,) rad, 0 = straight on.
        nodes: Gauss nodes a side.
        progress: told the share done; may raise `Cancelled`.

    Returns:
        `R`, `T_total` (T, S), shares of the beam; `L_up`, `L_down` (T, S, V, A), for each unit of irradiance on a
        plane that faces the sun, 1/sr.
    """
    needed = int(np.flatnonzero(np.abs(moments) > 1e-9).max()) + 1
    nodes = min(nodes, max((needed + 1) // 2, 4))
    streams = Streams(moments, np.concatenate([suns, views]), nodes, 2 * nodes, albedo)
    orders = np.arange(2 * nodes)[:, None]
    turns = np.cos(orders * azimuths) * np.where(orders == 0, 1, 2) / (2 * np.pi)
    shape = (len(depths), len(suns))
    found = {"R": np.empty(shape), "T_total": np.empty(shape)}
    found |= {side: np.empty((*shape, len(views), len(azimuths))) for side in ("L_up", "L_down")}
    first_view = streams.wanted.start + len(suns)
    chosen = (slice(None), slice(first_view, None), slice(streams.wanted.start, first_view))
    for row, depth in enumerate(depths):
        progress(row / len(depths), f"optical depth {depth:g}")
        if depth <= 0:
            for name in found:
                found[name][row] = float(name == "T_total")
            continue
        layer = streams.layers(np.array([depth]))[0]
        once = streams.single(layer.depth)
        found["R"][row] = streams.hemispherical(layer.reflection)[: len(suns)]
        found["T_total"][row] = streams.hemispherical(layer.transmission)[: len(suns)] + np.exp(-layer.depth / suns)
        for up, name in ((True, "L_up"), (False, "L_down")):
            more = (layer.reflection - once.reflection if up else layer.transmission - once.transmission)[chosen]
            slab = Slab.between(depth, suns[:, None, None], views[:, None], azimuths, up)
            first = _first(moments, streams, 2 * nodes, albedo, slab, up)
            found[name][row] = first + np.einsum("mvs,ma->sva", more, turns)
    return found


def _first(moments: np.ndarray, streams: Streams, cut: int, albedo: float, slab: Slab, up: bool) -> np.ndarray:
    """Order 1 of the scaled layer with the true phase function, and what the forward peak makes of it (`peak`)."""
    f = streams.peak * albedo
    found = albedo * values_of(moments, slab.cosine)
    found *= (first_up if up else first_down)(slab, streams.kept) / streams.kept
    if f < 1e-6:
        return found
    early = np.arange(len(moments)) < cut
    forward, behind = parts(moments)
    for place in np.ndindex(slab.cosine.shape[:2]):
        depth, sun, view = (float(array[place][0]) for array in (slab.optical_depth, slab.mu_sun, slab.mu_view))
        turned = (slab.cosine[place] <= 0) == up
        if up:
            path = depth * (1 / sun + 1 / view)
            spectrum = albedo * behind * escaping(np.where(early, f, albedo * forward), path) * sun / (sun + view)
            found[place][turned] = values_of(spectrum, slab.cosine[place][turned])
        else:
            # Along the mean of both paths, which are alike where the glow is.
            path = depth / np.sqrt(sun * view)
            scale = found[place] / np.maximum(albedo * values_of(moments, slab.cosine[place]), 1e-12)
            with np.errstate(under="ignore"):
                kept = np.where(early, f, albedo * moments)
                spectrum = transmitted_spectrum(albedo * moments, kept, f, min(path, 300.0))
            found[place][turned] = (values_of(spectrum, slab.cosine[place]) * scale)[turned]
    return np.maximum(found, 0)
