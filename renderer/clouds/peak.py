"""What the forward peak makes of order 1, where it is not followed as light of its own.

Delta-M takes the peak out: moments f up to its cut, those of the phase function's forward part beyond
(`kept_moments`). On the other side of a layer the peak is a glow around the sun; on the sunlit side it blurs fogbow
and glory. Both are in the angle exactly what small deflections along the two rays do (formulas a3), and go into one
table of factors on order 1 of the scaled layer.
"""

from __future__ import annotations

import numpy as np

from renderer.clouds.legendre import gauss, moments_of, values_of
from renderer.clouds.phase_tables import TABLE, table_cosines
from renderer.core.technique import Arrays

PATHS = 21
"""Optical paths in the table: even steps of the logarithm between LEAST and MOST."""

LEAST, MOST = -4.0, 6.0
"""Powers of two."""

AHEAD = TABLE // 2
"""Angles of the table that lie in the forward hemisphere."""

WINDOW = (np.cos(np.radians(20.0)), np.cos(np.radians(90.0)))
"""Cosines between which the forward part of the phase function passes into the part behind."""


def paths() -> np.ndarray:
    """Optical paths of the table."""
    return 2.0 ** np.linspace(LEAST, MOST, PATHS)


def parts(moments: np.ndarray) -> np.ndarray:
    """Moments (2, L) of the forward part of a phase function and of the rest, which hold all of it together."""
    nodes, weights = gauss(len(moments) + 200)
    share = np.clip((nodes - WINDOW[1]) / (WINDOW[0] - WINDOW[1]), 0, 1)
    ahead = moments_of(values_of(moments, nodes) * share**2 * (3 - 2 * share), nodes, weights, len(moments))
    return np.stack([ahead, moments - ahead])


def factors(phase: Arrays, peak: np.ndarray, cut: int) -> np.ndarray:
    """Factors on order 1 of the scaled layer with the true phase function.

    Args:
        phase: the bake `phase`. peak: (3,) share f of the peak. cut: the moment at which delta-M cut.

    Returns:
        (PATHS, TABLE, 3): in the forward hemisphere for light that leaves on the other side, by the optical path;
        behind it for light that leaves on the sunlit side, by the path in and out together.
    """
    moments, disc, cosines = phase["moments"], phase["disc"], table_cosines()
    ahead, behind = cosines[:AHEAD], cosines[AHEAD:]
    factor = np.ones((PATHS, TABLE, 3))
    for band, f in enumerate(peak):
        if f < 1e-6:
            continue
        forward, rest = parts(moments[band])
        early = np.arange(len(rest)) < cut
        value = np.maximum(values_of(moments[band] * disc, cosines), 1e-9)
        for row, path in enumerate(paths()):
            # Both over what delta-M alone would send, path e^(-(1 - f) path) and (1 - e^(-(1 - f) path)) / (1 - f).
            glow = transmitted_spectrum(moments[band], np.where(early, f, moments[band]), f, path)
            factor[row, :AHEAD, band] = values_of(glow * disc, ahead) / value[:AHEAD]
            blurred = rest * escaping(np.where(early, f, forward), path) / escaping(f, path)
            factor[row, AHEAD:, band] = values_of(blurred * disc, behind) / value[AHEAD:]
    return np.maximum(factor, 0)


def transmitted_spectrum(moments: np.ndarray, kept: np.ndarray, f: float, path: float) -> np.ndarray:
    """Order 1, what the peak leaves of it in the scaled layer, and two deflections and more by the peak alone.

    Order 1 is P t e^(-t); the rest of P goes as (P - f p) t (e^(-(1 - f) t) - e^-t); n deflections by the peak are
    Poisson's, e^-t (e^(f p t) - 1 - f p t). All over t e^(-(1 - f) t).

    Args:
        moments: (L,) of P. kept: (L,) of f p. f: share of the peak. path: t.
    """
    thinned = np.exp(-f * path)
    return moments * thinned - (moments - kept) * np.expm1(-f * path) + thinned / path * twice_or_more(kept * path)


def escaping(kept: np.ndarray | float, path: float) -> np.ndarray:
    """Order 1 on the sunlit side for a part of the spectrum of which small deflections keep the share `kept`: the
    integral of e^(-(1 - kept) x) over the path."""
    lost = 1 - np.asarray(kept)
    return -np.expm1(-lost * path) / lost


def twice_or_more(x: np.ndarray | float) -> np.ndarray:
    """e^x - 1 - x, exact for small x."""
    x = np.asarray(x, np.float64)
    small = np.where(np.abs(x) < 0.1, x, 0.0)
    series = small**2 / 2 * (1 + small / 3 * (1 + small / 4 * (1 + small / 5 * (1 + small / 6 * (1 + small / 7)))))
    return np.where(np.abs(x) < 0.1, series, np.expm1(np.minimum(x, 600)) - x)
