"""Lafortune's lobe: its formula, its fits, the voxels' own lobes and their coarser levels."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from renderer.forest import lobe, lobe_levels
from renderer.forest.light.lafortune import Lafortune
from tests.forest.blocks import blocks
from tests.forest.facing import Leaves, Twin, light_error
from tests.forest.truth import MARCH, Judge

Ask = Callable[..., np.ndarray]
STORED = np.array([200, 30, 140, 60], np.uint8)
VOLUME = {"light_lobe": np.broadcast_to(STORED, (2, 2, 2, 4)).copy()}
UNIFORM = Lafortune(coefficients="uniform", cxy=0.7, cz=-0.4, n=1.7)


def of(*coefficients: float) -> Twin:
    def twin(leaves: Leaves, sun: np.ndarray) -> np.ndarray:
        lit, seen = leaves.normal @ sun, np.sum(leaves.normal * leaves.to_eye, axis=1)
        cosine, c = leaves.to_eye @ sun, np.array(coefficients)
        front, behind = lobe.lobe(c, lit, seen, cosine), lobe.lobe(c, -lit, seen, -cosine)
        return (leaves.albedo * front[:, None] + leaves.passed * behind[:, None]) / np.pi

    return twin


def exact(leaves: Leaves, sun: np.ndarray) -> np.ndarray:
    """The formula in a frame of its own, after Cohen 2004: Cxy (sx vx + sy vy) + Cz sz vz, for sun in front alone."""
    result = np.zeros_like(leaves.albedo)
    for n, normal in enumerate(leaves.normal):
        z = normal if normal @ leaves.to_eye[n] > 0 else -normal
        x = np.cross(z, [0.0, 0.0, 1.0] if abs(z[2]) < 0.9 else [1.0, 0.0, 0.0])
        x /= np.linalg.norm(x)
        frame = np.stack([x, np.cross(z, x), z])
        s, v = frame @ sun, frame @ leaves.to_eye[n]
        inner = UNIFORM.cxy * (s[0] * v[0] + s[1] * v[1]) + UNIFORM.cz * s[2] * v[2]
        for sign, colour in ((1, leaves.albedo), (-1, leaves.passed)):
            result[n] += colour[n] / np.pi * max(sign * s[2], 0) * max(sign * inner, 0) ** UNIFORM.n
    return result


def test_a_uniform_lobe_is_the_thesis_formula(ask: Ask) -> None:
    assert light_error(ask, UNIFORM, exact, textures=VOLUME) < 1e-5
    assert light_error(ask, UNIFORM, of(UNIFORM.cxy, UNIFORM.cz, UNIFORM.n, 0), textures=VOLUME) < 1e-5


def test_a_stored_lobe_is_read_back(ask: Ask) -> None:
    assert light_error(ask, Lafortune(), of(*lobe.decode(STORED)), textures=VOLUME) < 1e-5


@pytest.mark.parametrize(("right", "wrong"), [
    ("(lobe.y - lobe.x) * lit", "(lobe.y - lobe.x)"),
    ("(seen < 0.0 ? -1.0 : 1.0)", "1.0"),
    ("lit < 0.0 && inner < 0.0", "inner < 0.0"),
    ("front * matter.albedo + behind * matter.passed", "front * matter.albedo"),
    ("stored.z * stored.z", "stored.z"),
    ("pow(max(abs(inner), 1e-6), lobe.z)", "pow(max(abs(inner), 1e-6), 0.5)"),
])
def test_a_wrong_lobe_is_found(ask: Ask, spoil: Callable, right: str, wrong: str) -> None:
    with spoil("forest/light/lafortune.glsl", right, wrong):
        assert light_error(ask, Lafortune(), of(*lobe.decode(STORED)), textures=VOLUME) > 0.01


def test_bytes_keep_a_lobe() -> None:
    drawn = np.random.default_rng(3).uniform(lobe.LEAST, lobe.MOST, (500, 4))
    error = np.abs(lobe.decode(lobe.encode(drawn)) - drawn)
    assert (error.max(axis=0) < [0.006, 0.006, 0.017, 0.001]).all()


@pytest.mark.parametrize("number", [4, 16, 28])
def test_the_kept_fits_are_those_of_the_leaves(number: int) -> None:
    """A fit made now is the one in the file, and so is its residual; exchanged coefficients are worse."""
    kept = json.loads(lobe.FITS.read_text())["lobes"][number]
    at = lobe.pairs()
    wanted = lobe.leaves_reflect(kept["kappa"], *at)
    made = lobe.fit(wanted, at, np.array([0.2, 0.6, 0.4, 0.1]))
    held = lobe.relative_residual(lobe.lobe(np.array(kept["coefficients"]), *at), wanted)
    assert held == pytest.approx(kept["residual"], abs=1e-4)
    assert made.residual == pytest.approx(held, abs=2e-3)
    cxy, cz, power, even = kept["coefficients"]
    assert lobe.relative_residual(lobe.lobe(np.array([cz, cxy, power, even]), *at), wanted) > 1.02 * held


def test_a_stalled_fit_is_annealed(monkeypatch: pytest.MonkeyPatch) -> None:
    at = lobe.pairs(20, 31)
    wanted = lobe.lobe(np.array([-0.9, 0.8, 2.5, 0.05]), *at)
    start = np.array([1.4, -1.4, 0.03, 0.4])
    search = lobe.least_squares
    monkeypatch.setattr(lobe, "least_squares", lambda *given, **more: search(*given, **more, max_nfev=1))
    found = lobe.fit(wanted, at, start)
    assert found.annealed
    assert found.residual < 0.05 < lobe.relative_residual(lobe.lobe(start, *at), wanted)


def test_lobes_keep_energy() -> None:
    """What every fitted lobe reflects of a beam to the half space of its eye is at most the albedo."""
    eye = lobe.directions(4000)[:2000]
    for tilt in np.radians([0, 30, 60, 85]):
        sun = np.array([np.sin(tilt), 0, np.cos(tilt)])
        lit, cosine = np.full(len(eye), sun[2]), eye @ sun
        for c in lobe.fitted()[1]:
            sent = lobe.lobe(c, lit, eye[:, 2], cosine) / np.pi
            # Per area of the leaves, all kappas: radiance times what is shown, over what the beam hits at most.
            assert 2 * np.pi * (sent * eye[:, 2]).mean() <= 1.05


def sent_by_blocks(pattern: dict[str, Any], level: int) -> tuple[np.ndarray, np.ndarray]:
    """What each block's voxels send through one another to eyes and suns of this test's own, by a plain march."""
    steps = np.array([(1, 1, 0), (1, 0, -1), (-1, 1, 0), (0, 1, -1)])
    eyes, lengths = lobe_levels.towards(steps)
    suns = lobe.directions(17)
    side = 2**level
    alpha = pattern["colour"][..., 3] / 255.0
    way, kappa = lobe_levels.mean_normals(pattern["normal"])
    k, j, i = (size // side for size in alpha.shape)
    total, shown = np.zeros((k, j, i, len(steps), len(suns))), np.zeros((k, j, i, len(steps)))
    for v, (step, length) in enumerate(zip(steps, lengths, strict=True)):
        through = np.ones(alpha.shape)
        for reach in range(1, side):
            for index in np.ndindex(*alpha.shape):
                other = np.array(index) + reach * step
                if (other // side == np.array(index) // side).all():
                    through[index] *= (1 - alpha[tuple(other)]) ** length
        weight = through * (1 - (1 - alpha) ** length)
        for s, sun in enumerate(suns):
            sent = weight * lobe.leaves_reflect(kappa, way @ sun, way @ eyes[v], np.full(alpha.shape, eyes[v] @ sun))
            total[..., v, s] = sent.reshape(k, side, j, side, i, side).sum(axis=(1, 3, 5))
        shown[..., v] = weight.reshape(k, side, j, side, i, side).sum(axis=(1, 3, 5))
    return total / shown[..., None], eyes @ suns.T


def level_error(pattern: dict[str, Any], levels: str, level: int, wanted: np.ndarray, cosine: np.ndarray) -> float:
    """Relative residual of a level's lobes, at eyes and suns that no fit saw."""
    made = lobe_levels.bake_lobes({"levels": levels}, {"pattern": pattern}, lambda share, words: None)
    way, _ = lobe_levels.mean_normals(pattern[f"normal_{level}"])
    eyes = lobe_levels.towards(np.array([(1, 1, 0), (1, 0, -1), (-1, 1, 0), (0, 1, -1)]))[0]
    lit, seen = (way @ lobe.directions(17).T)[..., None, :], (way @ eyes.T)[..., None]
    c = lobe.decode(made[f"lobe_{level}"])[..., None, None, :]
    return lobe.relative_residual(lobe.lobe(c, lit + 0 * seen, seen + 0 * lit, cosine + 0 * lit * seen), wanted)


@pytest.mark.parametrize(("level", "gain"), [(1, 0.8), (2, 0.8)])
def test_refitted_levels_are_nearer_than_averaged_ones(level: int, gain: float) -> None:
    pattern = blocks(disorder=0.7)
    wanted, cosine = sent_by_blocks(pattern, level)
    averaged, refitted = (level_error(pattern, name, level, wanted, cosine) for name in ("averaged", "refitted"))
    assert refitted < gain * averaged


def test_levels_of_equal_voxels_are_those_voxels() -> None:
    """Closed form: where all leaves lie alike the coarse lobe is the fine one, averaged or refitted."""
    pattern = blocks(disorder=0.0)
    for levels in ("averaged", "refitted"):
        made = lobe_levels.bake_lobes({"levels": levels}, {"pattern": pattern}, lambda share, words: None)
        at = lobe.pairs(10, 21)
        fine, coarse = (lobe.lobe(lobe.decode(made[name][1, 1, 1]), *at) for name in ("lobe", "lobe_2"))
        assert lobe.relative_residual(coarse, fine) < 0.05


def test_distance_to_the_reference(judge: Judge) -> None:
    judge.holds(
        "light", "lafortune",
        MARCH,
        0.046,  # one lobe in the place of leaves that face everywhere
    )


def test_the_thesis_lobe_costs_more(judge: Judge) -> None:
    uniform = {"light": {"kind": "lafortune", "coefficients": "uniform"}}
    assert judge.distance("light", "lafortune", **uniform) > 1.5 * judge.distance("light", "lafortune")


def test_picture(judge: Judge) -> None:
    judge.looks("light", "lafortune")
