"""Where techniques of light between ground and clouds fail: named cases with numbers, of no picture."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from renderer.clouds.radiosity.bases import GRID, haar_basis, largest_wavelets, object_basis
from renderer.clouds.radiosity.flat import bounce
from renderer.clouds.radiosity.kernel import flat_exchange
from renderer.clouds.radiosity.matrices import RENDERED
from renderer.clouds.radiosity.numbers import cut
from renderer.clouds.radiosity.solve import Answers, by_bounces, direct
from renderer.clouds.radiosity.transfer import Transfer, flat_transfer
from renderer.radiosity_study import Case, flat_exchanges, in_blocks, level_planes, matrix_line

Ring = Callable[[], Case]
"""Makes the validation scene with the ring of bright mountains, which takes rays."""


@dataclass(frozen=True)
class NumberCase:
    """One named failure whose symptom is a number.

    Attributes:
        name, title: of it. failing, surviving: techniques, in words.
        symptom: what is measured, in words. threshold: above it, it is a failure.
        measured: of the failing and of the surviving one when the case was written.
        cause: one sentence.
        measure: of both, now.
    """

    name: str
    title: str
    failing: str
    surviving: str
    symptom: str
    threshold: float
    measured: tuple[float, float]
    cause: str
    measure: Callable[[Ring], tuple[float, float]]

    def document(self, now: tuple[float, float]) -> dict[str, Any]:
        """As JSON values, with what is measured now."""
        said = {name: value for name, value in vars(self).items() if name != "measure"}
        return {**said, "failing_now": now[0], "surviving_now": now[1], "holds": now[1] <= self.threshold < now[0]}


def _truncated(ring: Ring) -> tuple[float, float]:
    return cut(4.0, 0.0)[0], cut(16.0, 0.0)[0]


def _coarse_basis(ring: Ring) -> tuple[float, float]:
    case = ring()
    return (matrix_line(case, "object", 64)[0]["ground"]["cells"], matrix_line(case, "haar", 256)[0]["ground"]["cells"])


def _level_over_relief(ring: Ring) -> tuple[float, float]:
    case = ring()
    ground = level_planes(case, flat_exchanges()["three_level (taps)"])[0]
    fine = ground.repeat(2, axis=0).repeat(2, axis=1)
    return in_blocks(fine, case.truth.ground), in_blocks(matrix_line(case, "haar", 256)[1][0], case.truth.ground)


def _bright(ring: Ring) -> tuple[float, float]:
    one = np.ones((1, 1), np.float32)
    planes = Transfer(one, one, 0 * one)
    answers, lit, exact = Answers(0.9 * one, 0.9 * one), (0.9 * one[0], 0 * one[0]), 0.81 / 0.19
    left = [
        1 - (1 + float(ground[0])) / (1 + exact)
        for ground in (by_bounces(planes, answers, *lit, 8)[0], direct(planes, answers, *lit)[0])
    ]
    return left[0], abs(left[1])


def _edges(ring: Ring) -> tuple[float, float]:
    """Broken cloud of blocks of 2.5H over dark ground: radiosity of the base, place by place."""
    blocks = np.random.default_rng(11).random((13, 13)) < 0.5
    cloud = np.kron(blocks, np.ones((5, 5)))[:GRID, :GRID].astype(np.float64)
    albedo, shine = np.full((GRID, GRID), 0.3), 0.9 * cloud
    fields = np.stack([0 * albedo, cloud, albedo, shine])[:, None]
    exact = cloud + shine * bounce(flat_exchange(GRID, 0.5), fields[0], fields[1], fields[2], fields[3], 40)[1][0]
    inner = (slice(GRID // 4, 3 * GRID // 4),) * 2
    errors = []
    for basis in (object_basis(15), haar_basis(largest_wavelets(exact[None], 256, RENDERED))):
        answers = Answers.of(basis, basis, albedo, shine)
        first = np.zeros(basis.n, np.float32), basis.analyse(cloud).astype(np.float32)
        found = basis.synthesise(first[1] + answers.cloud @ direct(flat_transfer(basis, basis), answers, *first)[1])
        errors.append(float(np.sqrt(np.mean((found - exact)[inner] ** 2)) / exact[inner].mean()))
    return errors[0], errors[1]


CASES: Sequence[NumberCase] = (
    NumberCase(
        "truncated_disc",
        "A disc of radius 4H is too small to compute on",
        "planes cut at 4H",
        "planes cut at 16H",
        "error of the ground's radiosity in the middle, 4 bounces",
        0.02,
        (0.1204, 0.0072),
        "Each half-bounce loses what comes from beyond the disc, and what its rim lacks is missing in the next one.",
        _truncated,
    ),
    NumberCase(
        "basis_too_coarse",
        "A basis coarser than a mountain spreads its influence",
        "blocks of 4H (64 coefficients)",
        "256 wavelets chosen by the light",
        "relative RMSE of the ground's radiosity against the truth averaged over the "
        "basis' cells, ring of bright mountains",
        0.03,
        (0.0862, 0.0245),
        "Within a block snow and dark ground share one number, so the clouds over either are lit alike.",
        _coarse_basis,
    ),
    NumberCase(
        "three_levels_over_relief",
        "Form factors of level planes do not know mountains",
        "three_level (taps)",
        "transfer haar 256",
        "relative RMSE of the ground's radiosity in means over 2H, ring of bright mountains",
        0.035,
        (0.0487, 0.0233),
        "Slopes see less cloud, stand nearer to it and light each other; level planes have none of it.",
        _level_over_relief,
    ),
    NumberCase(
        "albedo_near_one",
        "Four bounces are not enough over snow",
        "bounces, 4",
        "direct",
        "share of the light left out, albedo and reflectance 0.9",
        0.05,
        (0.349, 0.0),
        "Each bounce leaves R rho of the last one's light, and 0.81^5 of all is still to come.",
        _bright,
    ),
    NumberCase(
        "broken_edges",
        "A few blocks blur the edges of broken clouds",
        "transfer object 15",
        "256 wavelets",
        "relative RMSE of the base's radiosity, place by place, clouds and gaps of 2.5H",
        0.5,
        (0.757, 0.336),
        "A block holds cloud and gap in one number.",
        _edges,
    ),
)
