"""Reflection and transmission of a plane layer by doubling (van de Hulst 1963), with delta-M (Wiscombe 1977).

A kernel K(mu, mu') of azimuthal order m gives the radiance that leaves by mu for unit radiance that comes by mu': for
a beam of unit irradiance facing the sun, I = 1 / (2 pi) sum over m of (2 - delta_m0) K_m(mu, mu_sun) cos(m phi).
Layers are joined at Gauss nodes; cosines that are only asked for stand beside these with the weight 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from renderer.clouds.legendre import gauss

THINNEST = 1e-5
"""Optical depth below which a layer scatters twice at most: its third order is relatively THINNEST over mu, squared."""


@dataclass(frozen=True)
class Layer:
    """Kernels (M, n, n) of a layer, orders of azimuth first, and its optical depth after delta-M."""

    reflection: np.ndarray
    transmission: np.ndarray
    depth: float


class Streams:
    """Directions in which light is followed, and the phase function between them.

    Args:
        moments: (L,) of the phase function.
        asked: (k,) cosines at which kernels are wanted.
        nodes: Gauss nodes a side, N; delta-M cuts off the moment 2 N, as the share of an undeflected peak.
        orders: azimuthal orders kept, M.
        albedo: share of a meeting that is scattered.

    Attributes:
        mu, weight: (N + k,) of all directions. wanted: slice of those asked for.
        peak: share f of the peak. moments: (2 N,) of the rest, scaled.
        kept: optical depth after delta-M over that before, 1 - albedo f.
    """

    def __init__(self, moments: np.ndarray, asked: np.ndarray, nodes: int, orders: int, albedo: float = 1.0) -> None:
        padded = np.pad(moments, (0, max(2 * nodes + 1 - len(moments), 0)))
        self.peak = float(padded[2 * nodes])
        self.moments = (padded[: 2 * nodes] - self.peak) / (1 - self.peak)
        self.kept = 1 - albedo * self.peak
        self.albedo = albedo * (1 - self.peak) / self.kept
        x, w = gauss(nodes)
        self.mu = np.concatenate([(x + 1) / 2, asked])
        self.weight = np.concatenate([w / 2, np.zeros(len(asked))])
        self.wanted = slice(nodes, nodes + len(asked))
        functions = _legendre(self.mu, 2 * nodes, orders)
        scaled = functions * ((2 * np.arange(2 * nodes) + 1) / 2 * self.moments)[None, :, None]
        parity = np.where((np.arange(2 * nodes) + np.arange(orders)[:, None]) % 2, -1.0, 1.0)[..., None]
        self.forward = self.albedo * np.einsum("mli,mlj->mij", scaled, functions)
        self.backward = self.albedo * np.einsum("mli,mlj->mij", scaled * parity, functions)

    def single(self, depth: float) -> Layer:
        """The first order alone, in closed form (formulas a4), of a layer of that depth after delta-M."""
        return Layer(
            self.backward * reflected(depth, self.mu[:, None], self.mu),
            self.forward * transmitted(depth, self.mu[:, None], self.mu),
            depth,
        )

    def thin(self, depth: float) -> Layer:
        """A layer so thin that light scatters twice at most."""
        once = self.single(depth)
        back, on = self.backward / self.mu[:, None], self.forward / self.mu[:, None]
        w = self.weight[:, None]
        half = depth**2 / 2
        return Layer(
            once.reflection + half * (on @ (w * back) + back @ (w * on)),
            once.transmission + half * (on @ (w * on) + back @ (w * back)),
            depth,
        )

    def doubled(self, layer: Layer) -> Layer:
        """Two equal layers, one on the other."""
        w = self.weight[:, None]
        direct = np.exp(-layer.depth / self.mu)
        r, t = layer.reflection, layer.transmission
        bounced = r @ (w * r)
        between = np.linalg.solve(np.eye(len(self.mu)) - bounced * self.weight, bounced)
        down = t + between * direct + between @ (w * t)
        up = r * direct + r @ (w * down)
        return Layer(
            r + direct[:, None] * up + t @ (w * up),
            direct[:, None] * down + t * direct + t @ (w * down),
            2 * layer.depth,
        )

    def layers(self, depths: np.ndarray) -> list[Layer]:
        """A layer of each optical depth (before delta-M)."""
        scaled = self.kept * depths
        # Depths that are a power of two apart share their doublings.
        found: dict[float, Layer] = {}
        for depth in sorted(scaled):
            if depth / 2 not in found:
                times = max(int(np.ceil(np.log2(depth / THINNEST))), 0)
                layer = self.thin(depth / 2.0**times)
                for _ in range(times):
                    layer = self.doubled(layer)
            else:
                layer = self.doubled(found[depth / 2])
            found[depth] = layer
        return [found[depth] for depth in scaled]

    def hemispherical(self, kernel: np.ndarray) -> np.ndarray:
        """Share (k,) of a beam by each asked cosine that leaves in all directions of a kernel's side."""
        leaving = (self.weight * self.mu) @ kernel[0]
        return (leaving / self.mu)[self.wanted]


def reflected(depth: float, view: np.ndarray, sun: np.ndarray) -> np.ndarray:
    """Radiance of the first order that a layer sends back, over P: formulas a4."""
    return -np.expm1(-depth * (1 / view + 1 / sun)) * sun / (sun + view)


def transmitted(depth: float, view: np.ndarray, sun: np.ndarray) -> np.ndarray:
    """Radiance of the first order that a layer lets through, over P: formulas a4."""
    difference = depth * (1 / view - 1 / sun)
    # depth / view e^(-depth / sun) (1 - e^(-difference)) / difference, its limit where both cosines are equal.
    safe = np.where(np.abs(difference) < 1e-9, 1.0, difference)
    share = np.where(np.abs(difference) < 1e-9, 1.0, -np.expm1(-np.maximum(safe, -600)) / safe)
    return depth / view * np.exp(np.maximum(-depth / sun, -700)) * share


def _legendre(mu: np.ndarray, degrees: int, orders: int) -> np.ndarray:
    """Associated Legendre functions sqrt((l - m)! / (l + m)!) P_l^m, (orders, degrees, n)."""
    made = np.zeros((orders, degrees, len(mu)))
    sine = np.sqrt(np.maximum(1 - mu**2, 0))
    start = np.ones_like(mu)
    for m in range(min(orders, degrees)):
        if m:
            start = start * sine * np.sqrt((2 * m - 1) / (2 * m))
        made[m, m] = start
        if m + 1 < degrees:
            made[m, m + 1] = np.sqrt(2 * m + 1) * mu * start
        for degree in range(m + 2, degrees):
            scale = np.sqrt((degree - m) * (degree + m))
            lost = np.sqrt((degree - 1 - m) * (degree - 1 + m))
            made[m, degree] = ((2 * degree - 1) * mu * made[m, degree - 1] - lost * made[m, degree - 2]) / scale
    return made
