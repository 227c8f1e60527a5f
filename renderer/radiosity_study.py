"""Light between ground and clouds: every technique against form factors by rays, in the four scenes of Belcour's A.2.

Lengths are in heights of the cloud base, radiosities in the cloud's first one. The square of side 32H carries all light
there is; errors are over the square of side 16H that is drawn.
"""

from __future__ import annotations

import functools
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from renderer.clouds.radiosity.bases import GRID, HAAR_CELLS, HALF, Basis, haar_basis, largest_wavelets, object_basis
from renderer.clouds.radiosity.flat import Exchange, bounce
from renderer.clouds.radiosity.kernel import flat_exchange
from renderer.clouds.radiosity.levels import ThreeLevelExchange
from renderer.clouds.radiosity.matrices import RENDERED, basis_of, full_solution
from renderer.clouds.radiosity.relief import Hits, cast
from renderer.clouds.radiosity.scenes import ValidationScene, validation_scenes
from renderer.clouds.radiosity.solve import Answers, Squares, direct
from renderer.clouds.radiosity.transfer import Detail, Transfer, flat_transfer, relief_transfer
from renderer.core.baking import bake_now
from renderer.core.cache import Cache
from renderer.core.technique import Arrays, Bake
from renderer.reference.cloud_radiosity import Scene, Solution, by_quadrature, by_rays

Tell = Callable[[float, str], None]

BASES = ("object", "solid_angle", "haar")
COUNTS = (15, 64, 256)
FINE = 128
"""Cells along a side of the truth: of a quarter of a height."""

TIMES = FINE // GRID
DRAWN = slice(FINE // 4, 3 * FINE // 4)
HALF_BOUNCES = 60
"""Of techniques that count them: R rho = 0.72 leaves 5e-5."""


@dataclass(frozen=True, eq=False)
class Case:
    """A scene on the techniques' grid, and its truth.

    Attributes:
        scene, truth: on FINE x FINE cells. albedo, reflectance, cloud: (GRID, GRID). hits: rays over relief, if any.
        detail: what the matrices know of albedo, cover and the square's edge within a part.
    """

    scene: ValidationScene
    truth: Solution
    albedo: np.ndarray
    reflectance: np.ndarray
    cloud: np.ndarray
    hits: Hits | None
    detail: Detail

    def transfer(self, ground: Basis, cloud: Basis) -> Transfer:
        """Matrices between two bases."""
        if self.hits is None:
            return flat_transfer(ground, cloud, self.detail)
        return relief_transfer(self.hits, ground, cloud, self.detail)


def bake_truth(arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Tell) -> Arrays:
    """The truth of a validation scene, as a bake: radiosities and standard errors of ground and base."""
    given = next(scene for scene in validation_scenes(FINE) if scene.name == arguments["scene"])
    dark = np.zeros_like(given.albedo)
    scene = Scene(HALF, given.nodes, given.albedo, given.reflectance, dark, given.cloud)
    found = by_quadrature(scene) if scene.level else by_rays(scene, arguments["rays"], progress=progress)
    return dict(vars(found))


def cases(rays: int, cache: Cache, tell: Tell) -> Iterator[Case]:
    """The four scenes with their truths.

    Args:
        rays: of each point of the truth, and half as many of each cell of the matrices.
    """
    scenes = validation_scenes(FINE)
    for k, scene in enumerate(scenes):
        tell(k / len(scenes), f"truth: {scene.title}")
        level = not scene.nodes.any()
        arguments = {"scene": scene.name, "rays": 0 if level else rays}
        truth = Solution(**bake_now(Bake("radiosity_truth", bake_truth, arguments), cache))
        albedo, shine, cloud = (_coarse(field) for field in (scene.albedo, scene.reflectance, scene.cloud))
        hits = None if level else cast(scene.nodes, max(rays // 2, 64))
        detail = Detail(albedo, (cloud > 0).astype(np.float64), edge=True)
        yield Case(scene, truth, albedo, shine, cloud, hits, detail)


def _coarse(field: np.ndarray) -> np.ndarray:
    return np.asarray(field.reshape(GRID, TIMES, GRID, TIMES).mean(axis=(1, 3)))


def _fine(field: np.ndarray) -> np.ndarray:
    return field.repeat(TIMES, axis=0).repeat(TIMES, axis=1)


def off(found: np.ndarray, right: np.ndarray, over: np.ndarray | None = None) -> float:
    """Root mean square of a difference over the drawn square, in means of what is right (or `over`)."""
    mean = (right if over is None else over)[DRAWN, DRAWN].mean()
    return float(np.sqrt(np.mean((found - right)[DRAWN, DRAWN] ** 2)) / mean)


def flat_exchanges() -> dict[str, Exchange]:
    """Half-bounces of the techniques that know level planes alone."""
    levels = {
        f"three_level ({reading})": ThreeLevelExchange(GRID, 2 * HALF / GRID, 1.0, reading)
        for reading in ("texels", "taps", "discs")
    }
    return {"fft": flat_exchange(GRID, 2 * HALF / GRID), **levels}


def level_planes(case: Case, exchange: Exchange) -> tuple[np.ndarray, np.ndarray]:
    """Radiosities of ground and base by such a technique, (GRID, GRID)."""
    dark, albedo, shine, cloud = (f[None] for f in (0 * case.albedo, case.albedo, case.reflectance, case.cloud))
    ground, base = bounce(exchange, dark, cloud, albedo, shine, HALF_BOUNCES)
    return case.albedo * ground[0], case.cloud + case.reflectance * base[0]


@functools.lru_cache(maxsize=4)
def whole(case: Case) -> tuple[np.ndarray, np.ndarray]:
    """Radiosities of ground and base by matrices with all wavelets, (GRID, GRID)."""
    every = haar_basis(np.arange(HAAR_CELLS * HAAR_CELLS))
    given = (case.albedo, case.reflectance, 0 * case.albedo, case.cloud)
    return full_solution(case.transfer(every, every), every, *given)


def chosen(case: Case, kind: str, count: int) -> tuple[Basis, Basis]:
    """Ground's and cloud's basis; wavelets are chosen by the solution with all of them."""
    if kind != "haar":
        return (basis_of(kind, count),) * 2
    ground, cloud = (haar_basis(largest_wavelets(field[None], count, RENDERED)) for field in whole(case))
    return ground, cloud


def in_basis(case: Case, ground: Basis, cloud: Basis) -> tuple[np.ndarray, np.ndarray]:
    """Coefficients of the radiosities of ground and base by transfer matrices."""
    answers = Answers.of(ground, cloud, case.albedo, case.reflectance)
    first = np.zeros(ground.n, np.float32), cloud.analyse(case.cloud).astype(np.float32)
    found = direct(case.transfer(ground, cloud), answers, *first)
    return answers.ground @ found[0], first[1] + answers.cloud @ found[1]


def gathered(case: Case, ground: Basis, cloud: Basis) -> list[np.ndarray]:
    """Radiosities of ground and base, (GRID, GRID), as the renderer has them: each place gathers by the kernel of level
    planes what the basis found, and the basis keeps what relief changes."""
    transfer, level = case.transfer(ground, cloud), flat_transfer(ground, cloud, case.detail)
    from_ground, from_cloud = in_basis(case, ground, cloud)
    exchange = flat_exchange(GRID, 2 * HALF / GRID)
    answers = Answers.of(ground, cloud, case.albedo, case.reflectance)
    first = np.zeros(ground.n, np.float32), cloud.analyse(case.cloud).astype(np.float32)
    above = cloud.synthesise((transfer.from_ground - level.from_ground) @ from_ground)
    below = ground.synthesise((transfer.from_cloud - level.from_cloud) @ from_cloud + transfer.on_ground @ from_ground)
    sent = case.cloud + case.reflectance * cloud.synthesise(direct(transfer, answers, *first)[1])
    back = case.albedo * (exchange(sent) + below)
    sent = case.cloud + case.reflectance * (exchange(back) + above)
    return [case.albedo * (exchange(sent) + below), sent]


def matrix_line(case: Case, kind: str, count: int) -> tuple[dict[str, Any], list[np.ndarray]]:
    """Errors of transfer matrices in one basis, and their radiosities on the truth's cells."""
    bases = chosen(case, kind, count)
    line: dict[str, Any] = {"scene": case.scene.name, "technique": f"transfer {kind}", "coefficients": count}
    fields = []
    for side, basis, found, right in zip(
        ("ground", "cloud"), bases, in_basis(case, *bases), (case.truth.ground, case.truth.cloud), strict=True
    ):
        field, kept = _fine(basis.synthesise(found)), _fine(basis.synthesise(basis.analyse(_coarse(right))))
        floor, point = off(kept, right), off(field, right)
        line[side] = {"cells": off(field, kept, right), "floor": floor, "pointwise": point, "ratio": point / floor}
        fields.append(field)
    return line, fields


def plain_line(case: Case, name: str, found: list[np.ndarray]) -> dict[str, Any]:
    """Errors of radiosities of ground and base (FINE, FINE) that are in no basis."""
    sides = zip(("ground", "cloud"), found, (case.truth.ground, case.truth.cloud), strict=True)
    errors = {side: {"pointwise": off(field, right), "blocks": in_blocks(field, right)} for side, field, right in sides}
    return {"scene": case.scene.name, "technique": name, **errors}


def scene_lines(case: Case) -> tuple[list[dict[str, Any]], dict[str, list[np.ndarray]]]:
    """Errors of every technique in one scene, and the radiosities of ground and base (FINE, FINE) by technique."""
    truth = case.truth
    dark = {
        "ground": {"pointwise": off(0 * truth.ground, truth.ground)},
        "cloud": {"pointwise": off(case.scene.cloud, truth.cloud)},
    }
    lines: list[dict[str, Any]] = [{"scene": case.scene.name, "technique": "none", **dark}]
    fields: dict[str, list[np.ndarray]] = {"truth": [truth.ground, truth.cloud]}
    for name, exchange in flat_exchanges().items():
        found = [_fine(field) for field in level_planes(case, exchange)]
        fields[name] = found
        lines.append(plain_line(case, name, found))
    for kind in BASES:
        for count in COUNTS:
            line, both = matrix_line(case, kind, count)
            for side, field, right in zip(("ground", "cloud"), both, fields["truth"], strict=True):
                line[side]["blocks"] = in_blocks(field, right)
            lines.append(line)
            fields[f"transfer {kind} {count}"] = both
            both = [_fine(field) for field in gathered(case, *chosen(case, kind, count))]
            lines.append({**plain_line(case, f"transfer {kind}, gathered", both), "coefficients": count})
            fields[f"transfer {kind} {count}, gathered"] = both
    noise = {
        side: off(right + error, right)
        for side, right, error in (
            ("ground", truth.ground, truth.ground_error),
            ("cloud", truth.cloud, truth.cloud_error),
        )
    }
    lines.append(
        {
            "scene": case.scene.name,
            "technique": "truth's own error",
            **{side: {"pointwise": error} for side, error in noise.items()},
        }
    )
    return lines, fields


def in_blocks(found: np.ndarray, right: np.ndarray) -> float:
    """The error of means over blocks of 2H: what every technique can be held to."""
    blocks = object_basis(256)
    means = [_fine(blocks.synthesise(blocks.means(_coarse(field)))) for field in (found, right)]
    return off(means[0], means[1], right)


def solving_time(squares: int = 256, coefficients: int = 64, times: int = 20) -> dict[str, float]:
    """CPU time of solving many squares anew for a moved sun, three bands, and of preparing them, ms."""
    basis = object_basis(coefficients)
    chance = np.random.default_rng(1)
    albedo, shine = chance.uniform(0.1, 0.9, (2, squares, 3, coefficients)).astype(np.float32)
    first = chance.random((squares, 3, coefficients), np.float32)
    flat = flat_transfer(basis, basis)
    start = time.process_time()
    solver = Squares([flat] * squares, albedo, shine)
    prepared = time.process_time()
    for _ in range(times):
        solver.solve(first, 0 * first)
    return {
        "squares": squares,
        "coefficients": coefficients,
        "bands": 3,
        "prepare_ms": 1e3 * (prepared - start),
        "solve_ms": 1e3 * (time.process_time() - prepared) / times,
    }
