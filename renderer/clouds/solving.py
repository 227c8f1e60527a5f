"""The light of plane layers at chosen directions, by doubling with no table between: what `measure slab` calls
`doubling`.

Orders 1 and the forward peak's are exact in the angle, as the technique `adding_doubling` has them (`slab_tables`);
all that is left is followed in as many azimuthal orders as there are moments after delta-M.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from renderer.clouds.doubling import Streams
from renderer.clouds.legendre import values_of
from renderer.clouds.slab import Slab, first_down, first_up
from renderer.clouds.slab_tables import twice_or_more

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
    kept = np.where(np.arange(len(moments)) < 2 * nodes, streams.peak, moments)
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
            first = _first(moments, kept, streams, albedo, slab, up)
            found[name][row] = first + np.einsum("mvs,ma->sva", more, turns)
    return found


def _first(moments: np.ndarray, kept: np.ndarray, streams: Streams, albedo: float, slab: Slab, up: bool) -> np.ndarray:
    """Order 1 of the scaled layer with the true phase function; below, with what the forward peak makes of it
    (formulas a3)."""
    value = albedo * values_of(moments, slab.cosine)
    if up:
        return value * first_up(slab, streams.kept) / streams.kept
    once = first_down(slab)
    rest = albedo * values_of(moments - kept, slab.cosine) * (first_down(slab, streams.kept) / streams.kept - once)
    glow = np.zeros_like(slab.cosine)
    for place in np.ndindex(slab.cosine.shape[:2]):
        # Along the mean of both paths, which are alike where the glow is.
        path = float(slab.optical_depth[place][0] / np.sqrt(slab.mu_sun[place][0] * slab.mu_view[place][0]))
        if streams.peak > 0:
            with np.errstate(under="ignore"):
                spectrum = np.exp(-min(path, 700.0)) * twice_or_more(albedo * kept * path)
            glow[place] = values_of(spectrum, slab.cosine[place])
    return np.maximum(value * once + rest + glow, 0)
