"""Where techniques of light between ground and clouds fail: the numbers and charts of their cases."""

from __future__ import annotations

import functools

import numpy as np

from renderer.clouds.failures import FAILURES
from renderer.clouds.radiosity import numbers
from renderer.clouds.radiosity.bases import GRID, HALF, haar_basis, largest_wavelets, object_basis
from renderer.clouds.radiosity.flat import bounce
from renderer.clouds.radiosity.kernel import flat_exchange
from renderer.clouds.radiosity.matrices import RENDERED
from renderer.clouds.radiosity.solve import Answers, by_bounces, direct
from renderer.clouds.radiosity.transfer import Transfer, flat_transfer
from renderer.clouds.radiosity.two_planes import solve
from renderer.core.cache import Cache
from renderer.core.failure import Charted, ChartedFailure, Curve
from renderer.radiosity_study import Case, cases, flat_exchanges, in_blocks, level_planes, matrix_line

CASES = tuple(one for one in FAILURES if isinstance(one, ChartedFailure) and one.measure.startswith(f"{__name__}:"))

RING_RAYS = 1024
"""Of each point of the truth over mountains: standard error 0.2 % at most."""

PLACE = "place, heights of the cloud base"


@functools.cache
def ring() -> Case:
    """The validation scene with the ring of bright mountains."""
    return next(case for case in cases(RING_RAYS, Cache(), lambda share, words: None) if case.scene.name == "ring")


def truncated_disc() -> Charted:
    """Planes cut at 4H and at 16H against endless ones, four bounces."""
    shares = np.linspace(0, 0.9, 46)
    errors = [-solve(numbers.GROUND, numbers.CLOUD, r, 4, shares * r).ground_error[-1] for r in (4.0, 16.0)]
    return Charted(
        float(errors[0][0]),
        float(errors[1][0]),
        (
            Curve("failing", shares, errors[0]),
            Curve("surviving", shares, errors[1]),
        ),
        "distance from the axis over the disc's radius",
        "light that the ground lacks, share",
        "y",
    )


def coarse_basis() -> Charted:
    """Blocks of 4H against 256 wavelets over the ring of bright mountains."""
    blocks, wavelets = (matrix_line(ring(), *kind) for kind in (("object", 64), ("haar", 256)))
    return _profiles(
        blocks[0]["ground"]["cells"], wavelets[0]["ground"]["cells"], blocks[1][0], wavelets[1][0], ring().truth.ground
    )


def three_levels() -> Charted:
    """Three levels of form factors against matrices that know the relief, ring of bright mountains."""
    found = level_planes(ring(), flat_exchanges()["three_level (taps)"])[0]
    fine = found.repeat(2, axis=0).repeat(2, axis=1)
    wavelets, truth = matrix_line(ring(), "haar", 256)[1][0], ring().truth.ground
    return _profiles(in_blocks(fine, truth), in_blocks(wavelets, truth), fine, wavelets, truth)


def _profiles(failing: float, surviving: float, wrong: np.ndarray, right: np.ndarray, truth: np.ndarray) -> Charted:
    """A chart of radiosities (N, N) along the middle of the square that is drawn."""
    n = len(truth)
    places = ((np.arange(n) + 0.5) * 2 * HALF / n - HALF)[n // 4 : 3 * n // 4]
    rows = [field[n // 2 - 1 : n // 2 + 1].mean(axis=0)[n // 4 : 3 * n // 4] for field in (truth, wrong, right)]
    return Charted(
        failing,
        surviving,
        (
            Curve("truth", places, rows[0]),
            Curve("failing", places, rows[1]),
            Curve("surviving", places, rows[2]),
        ),
        PLACE,
        "radiosity over the cloud's first",
    )


def albedo_near_one() -> Charted:
    """Bounces counted one by one against the solution of all, endless planes of albedo and reflectance 0.9."""
    one = np.ones((1, 1), np.float32)
    planes = Transfer(one, one, 0 * one)
    answers, lit, exact = Answers(0.9 * one, 0.9 * one), (0.9 * one[0], 0 * one[0]), 0.81 / 0.19
    counts = np.arange(1, 21)

    def left(ground: np.ndarray) -> float:
        return float(1 - (1 + float(ground[0])) / (1 + exact))

    counted = [left(by_bounces(planes, answers, *lit, 2 * int(n))[0]) for n in counts]
    at_once = abs(left(direct(planes, answers, *lit)[0]))
    return Charted(
        counted[3],
        at_once,
        (
            Curve("failing", counts, np.array(counted), "bounces one by one"),
            Curve("surviving", counts, np.full(len(counts), at_once)),
        ),
        "bounces",
        "share of the light left out",
    )


def broken_edges() -> Charted:
    """Broken cloud of blocks of 2.5H over dark ground: radiosity of the base, place by place."""
    blocks = np.random.default_rng(11).random((13, 13)) < 0.5
    cloud = np.kron(blocks, np.ones((5, 5)))[:GRID, :GRID].astype(np.float64)
    albedo, shine = np.full((GRID, GRID), 0.3), 0.9 * cloud
    fields = np.stack([0 * albedo, cloud, albedo, shine])[:, None]
    exact = cloud + shine * bounce(flat_exchange(GRID, 0.5), fields[0], fields[1], fields[2], fields[3], 40)[1][0]
    inner = (slice(GRID // 4, 3 * GRID // 4),) * 2
    errors, found = [], []
    for basis in (object_basis(15), haar_basis(largest_wavelets(exact[None], 256, RENDERED))):
        answers = Answers.of(basis, basis, albedo, shine)
        first = np.zeros(basis.n, np.float32), basis.analyse(cloud).astype(np.float32)
        solved = direct(flat_transfer(basis, basis), answers, *first)[1]
        found.append(basis.synthesise(first[1] + answers.cloud @ solved))
        errors.append(float(np.sqrt(np.mean((found[-1] - exact)[inner] ** 2)) / exact[inner].mean()))
    return _profiles(errors[0], errors[1], found[0], found[1], exact)
