"""The numbers of Belcour's chapter 5 that must come out, computed anew beside what the thesis prints."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from scipy.integrate import quad

from renderer.clouds.radiosity.form_factors import disc, footprints, level_weights, square
from renderer.clouds.radiosity.two_planes import solve

GROUND, CLOUD = 0.3, 0.9
"""Albedos of the thesis' examples."""

RADIUS_M = 6.35e6
"""Of the Earth, as the thesis has it. m"""

SURFACE_KM2 = 510_067_420.0
"""Of the Earth, as the thesis has it. km2"""


@dataclass(frozen=True)
class Number:
    """One value.

    Attributes:
        quantity, where: what it is, and the thesis' section. printed: as the thesis prints it, or empty.
        right: by a closed form or an independent computation. computed: by this software. tolerance: relative.
        note: why the printed value differs, where it does.
    """

    quantity: str
    where: str
    printed: str
    right: float
    computed: float
    tolerance: float
    note: str = ""

    @property
    def agrees(self) -> bool:
        """Whether the software gives the right value."""
        return abs(self.computed - self.right) <= self.tolerance * abs(self.right)

    def document(self) -> dict[str, Any]:
        """As JSON values."""
        return {**asdict(self), "agrees": self.agrees}


def cloud_share(height: float, radius: float = RADIUS_M) -> float:
    """Share of its hemisphere that a point of a spherical cloud base sees of the base itself (errata 001-5).

    Args:
        height: of the base above the ground, m. radius: of the planet, m.
    """
    # 1 - (R / H1)^2 without the cancellation
    base = radius + height
    return height * (radius + base) / (base * base)


def half_bowl(angle: np.ndarray | float) -> np.ndarray:
    """Share of the hemisphere that a half-bowl of this horizon takes: the thesis' slope (errata 001-21). Radians."""
    return np.square(np.sin(angle)) / 2


def plane_slope(angle: np.ndarray | float) -> np.ndarray:
    """Share that level ground takes of the hemisphere of a plane slope. Radians."""
    return (1 - np.cos(angle)) / 2


def valley(angle: np.ndarray | float) -> np.ndarray:
    """Share that slopes of this horizon take all round. Radians."""
    return np.square(np.sin(angle))


def ground_ground_error(share: np.ndarray, ground: float = GROUND, cloud: float = CLOUD) -> np.ndarray:
    """Error of the irradiance where ground, which fills a share of the hemisphere, is taken for cloud."""
    return np.asarray(share) * abs(ground - cloud) / cloud


def worst_slope_error(share: Callable[[float], np.ndarray]) -> float:
    """Largest error over slopes of 0 to 90 degrees."""
    return float(np.max([ground_ground_error(share(angle)) for angle in np.linspace(0, np.pi / 2, 91)]))


def truncation(product: float, bounces: int) -> float:
    """Share of the sum that is left out after some bounces: (R_c rho_g)^(n + 1)."""
    return product ** (bounces + 1)


def summed_truncation(product: float, bounces: int) -> float:
    """The same, by summing the bounces between uniform planes."""
    total, term = 0.0, 1.0
    for _ in range(bounces + 1):
        total += term
        term *= product
    return 1 - total * (1 - product)


def cells_of_the_earth(height: float, side: float = 16.0) -> int:
    """Squares that cover the Earth, of a side in cloud heights [m] (errata 001-8)."""
    return round(SURFACE_KM2 * 1e6 / (side * height) ** 2)


def matrix_bytes(coefficients: int) -> int:
    """Of the three matrices of one disc, in float32."""
    return 3 * 4 * coefficients**2


def cut(radius: float, at: float, bounces: int = 4) -> tuple[float, float]:
    """Error of ground and cloud at a distance from the axis, both planes cut to a disc; in heights."""
    found = solve(GROUND, CLOUD, radius, bounces, np.array([at]))
    return -float(found.ground_error[-1, 0]), -float(found.cloud_error[-1, 0])


def _shares() -> list[Number]:
    def lost(radius: float) -> float:
        inside, _ = quad(lambda t: np.cos(t) * np.sin(t), 0, np.arctan(radius))
        return 1 - 2 * inside

    found = [
        Number("hemisphere lost beyond a disc of radius 8H", "5.1.2", "1.5 %", 1 / 65, lost(8.0), 1e-9),
        Number("the same, closed form", "5.1.2", "1.5 %", 1 / 65, float(1 - disc(8.0)), 1e-12),
    ]
    for side, right in ((8, 0.0486), (16, 0.0126), (32, 0.00319)):
        found.append(
            Number(
                f"hemisphere lost beyond a square of side {side}H",
                "5.1.1",
                "",
                right,
                float(1 - square(side)),
                2e-3,
                "a texel 8H wide reaches 4H only (errata 001-6)",
            )
        )
    shares = ((500.0, "0.8e-3", 1.575e-4), (1500.0, "2.3e-3", 4.722e-4), (2500.0, "3.9e-3", 7.869e-4))
    for height, printed, right in shares:
        found.append(
            Number(
                f"share of cloud that a cloud base {height:g} m high sees",
                "5.1.3",
                printed,
                right,
                cloud_share(height),
                1e-3,
                "printed ten times too large, and half of it (errata 001-5)",
            )
        )
    return found


def _slopes() -> list[Number]:
    found = [
        Number(
            "largest error of flat ground, half-bowl of the thesis",
            "5.1.3",
            "30 %",
            1 / 3,
            worst_slope_error(half_bowl),
            1e-9,
            "at 90 degrees (errata 001-21)",
        ),
        Number("the same, plane slope", "5.1.3", "", 1 / 3, worst_slope_error(plane_slope), 1e-9, "at 90 degrees"),
        Number(
            "the same, valley all round",
            "5.1.3",
            "",
            2 / 3,
            worst_slope_error(valley),
            1e-9,
            "the half-bowl bounds nothing",
        ),
    ]
    angle = np.pi / 4
    for name, share, right in (
        ("half-bowl", half_bowl, 1 / 6),
        ("plane slope", plane_slope, 0.0976311),
        ("valley all round", valley, 1 / 3),
    ):
        found.append(
            Number(
                f"error of flat ground at 45 degrees, {name}",
                "5.1.3",
                "",
                right,
                float(ground_ground_error(share(angle))),
                1e-5,
            )
        )
    return found


def _bounces() -> list[Number]:
    found = []
    for product, bounces in ((0.27, 2), (0.27, 4), (0.72, 4), (0.72, 8), (0.81, 4), (0.81, 8)):
        note = "4 bounces suffice over dark ground only (errata 001-10)" if product > 0.5 else ""
        found.append(
            Number(
                f"left out after {bounces} bounces, R rho = {product:g}",
                "5.2.1",
                "4 bounces suffice" if bounces == 4 else "",
                truncation(product, bounces),
                summed_truncation(product, bounces),
                1e-9,
                note,
            )
        )
    # From errata 001-9, and the reference values of two planes.
    wanted = (
        (16, 0, "< 1 %", 0.0072, None),
        (16, 8, "< 1 % and < 2 %", 0.0135, 0.0060),
        (8, 0, "1.5 %", 0.031, None),
        (8, 4, "about 10 %", 0.055, None),
        (32, 16, "", 0.0031, None),
    )
    for radius, at, printed, ground, cloud in wanted:
        found_ground, found_cloud = cut(radius, at)
        name = f"error at {at}H of planes cut at {radius}H, 4 bounces"
        found.append(Number(f"{name}, ground", "5.2.2, A.1", printed, ground, found_ground, 0.02, "errata 001-9"))
        if cloud is not None:
            found.append(Number(f"{name}, cloud", "5.2.2, A.1", printed, cloud, found_cloud, 0.02, "errata 001-9"))
    return found


def _memory() -> list[Number]:
    return [
        Number(
            "render squares of side 16H that cover the Earth, H = 2.5 km",
            "5.2.3",
            "80 000",
            318_792,
            cells_of_the_earth(2500),
            1e-6,
            "80 000 are squares of side 32H (errata 001-7, 001-8)",
        ),
        Number(
            "the thesis' own discs of radius 32H",
            "5.2.3",
            "80 000",
            25_369,
            round(SURFACE_KM2 / (np.pi * 80**2)),
            1e-6,
            "its own formula (errata 001-8)",
        ),
        Number("bytes of G, C and S of one disc, 64 coefficients", "5.2.3", "", 49_152, matrix_bytes(64), 0),
        Number(
            "GB of matrices for the Earth, 64 coefficients",
            "5.2.3",
            "",
            15.7,
            matrix_bytes(64) * cells_of_the_earth(2500) / 1e9,
            5e-3,
            "flat cells share one set",
        ),
    ]


def _levels() -> list[Number]:
    found = []
    printed = {"texels": (0.1346, 0.3931, 0.4238), "taps": (0.4618, 0.3588, 0.1668), "discs": (0.400, 0.388, 0.197)}
    for reading in ("texels", "taps", "discs"):
        weights = level_weights(reading, spread_loss=False)
        for level, right, weight in zip(("H", "2H", "8H"), printed[reading], weights, strict=True):
            found.append(
                Number(f"weight of level {level}, {reading}", "5.1.1", "", right, float(weight), 2e-3, "formulas a7")
            )
        lost = float(1 - footprints(reading)[1][-1])
        right = {"texels": 0.0486, "taps": 0.0126, "discs": 1 / 65}[reading]
        found.append(Number(f"lost beyond the widest level, {reading}", "5.1.2", "1.5 %", right, lost, 2e-3))
    return found


def numbers() -> list[Number]:
    """Every value, computed now."""
    return [*_shares(), *_slopes(), *_bounces(), *_memory(), *_levels()]
