"""SGGX microflakes: visible flakes, what they send, and their coarser levels."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.forest import sggx
from renderer.forest.light.sggx import Sggx
from renderer.forest.lobe import directions
from tests.forest.facing import Leaves, light_error, unit
from tests.forest.truth import MARCH, Judge

Ask = Callable[..., np.ndarray]
MATRIX = np.array([0.30, 0.12, 0.21, 0.06, -0.09, 0.05])
SPREAD, LEAN = sggx.encode(MATRIX)
VOLUME = {f"light_{name}": np.broadcast_to(a, (2, 2, 2, 4)).copy() for name, a in (("spread", SPREAD), ("lean", LEAN))}
STORED = sggx.decode(SPREAD, LEAN)


def full(matrix: np.ndarray) -> np.ndarray:
    xx, yy, zz, xy, xz, yz = matrix
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def twin(leaves: Leaves, sun: np.ndarray) -> np.ndarray:
    lit = sggx.visible(np.tile(STORED, (len(leaves.to_eye), 1)), leaves.to_eye) @ sun
    front, behind = np.maximum(lit, 0).mean(axis=1), np.maximum(-lit, 0).mean(axis=1)
    return (leaves.albedo * front[:, None] + leaves.passed * behind[:, None]) / np.pi


def by_definition(eye: np.ndarray, sun: np.ndarray) -> float:
    """Mean of max(m.s, 0) over visible flakes: the integral of D(m) max(m.v, 0) max(m.s, 0) over that without the sun,
    D(m) = 1 / (pi sqrt|S| (m S^-1 m)^2) (Heitz et al. 2015, equation 7)."""
    m = directions(40000)
    density = np.einsum("na,ab,nb->n", m, np.linalg.inv(full(STORED)), m) ** -2.0
    shown = np.maximum(m @ eye, 0)
    return float((density * shown * np.maximum(m @ sun, 0)).sum() / (density * shown).sum())


def test_the_light_is_that_of_the_visible_flakes(ask: Ask) -> None:
    assert light_error(ask, Sggx(), twin, textures=VOLUME) < 1e-4


@pytest.mark.parametrize(("right", "wrong"), [
    ("lean * root.xxy * root.yzz", "lean * root.xxy"),
    ("area * j - (ki * ji - kj * ii) / area * k", "area * j + (ki * ji - kj * ii) / area * k"),
    ("sqrt(max(determinant(S), 1e-12))", "max(determinant(S), 1e-12)"),
    ("place.z * along_w", "along_w"),
    ("behind * matter.passed", "behind * matter.albedo"),
])
def test_a_wrong_light_is_found(ask: Ask, spoil: Callable, right: str, wrong: str) -> None:
    with spoil("forest/light/sggx.glsl", right, wrong):
        assert light_error(ask, Sggx(), twin, textures=VOLUME) > 2e-3


def test_visible_flakes_are_those_of_the_definition() -> None:
    rng = np.random.default_rng(4)
    for eye, sun in unit(rng.normal(size=(12, 2, 3))):
        exact = by_definition(eye, sun)
        many = sggx.reflected(STORED[None], eye[None], sun[None], points=4000)[0, 0, 0]
        few = sggx.reflected(STORED[None], eye[None], sun[None])[0, 0, 0]
        assert many == pytest.approx(exact, abs=2e-3)
        assert few == pytest.approx(exact, abs=0.05)


def test_leaves_show_what_their_flakes_do() -> None:
    """Closed form at the two axes: (1 + kappa) / 2 along the normal, (1 - kappa) / 2 across."""
    for kappa in (0.0, 0.3, 0.8):
        s = full(sggx.matrices(np.array([0.0, 0.6, 0.8]), np.array(kappa)))
        shown_from = {(0, 0.6, 0.8): (1 + kappa) / 2, (1, 0, 0): (1 - kappa) / 2, (0, 0.8, -0.6): (1 - kappa) / 2}
        for v, shown in shown_from.items():
            assert np.sqrt(np.array(v) @ s @ np.array(v)) == pytest.approx(shown)


def test_a_coarse_matrix_is_the_mean_of_its_children() -> None:
    colour = np.zeros((2, 2, 2, 4), np.uint8)
    colour[..., 3] = 80
    normal = np.full((2, 2, 2, 4), 128, np.uint8)
    normal[0, ..., :3], normal[1, ..., :3] = (255, 128, 128), (128, 128, 255)
    pattern = {"colour": colour, "normal": normal, "colour_1": colour[:1, :1, :1], "normal_1": normal[:1, :1, :1]}
    made = sggx.bake_sggx({}, {"pattern": pattern}, lambda share, words: None)
    found = sggx.decode(made["spread_1"], made["lean_1"])[0, 0, 0]
    flat = sggx.FLATTEST**2
    assert found == pytest.approx([(1 + flat) / 2, flat, (1 + flat) / 2, 0, 0, 0], abs=0.01)


def test_distance_to_the_reference(judge: Judge) -> None:
    judge.holds(
        "light", "sggx",
        MARCH,
        0.029,  # one ellipsoid for leaves of which some lie flat; twelve flakes for all
    )


def test_picture(judge: Judge) -> None:
    judge.looks("light", "sggx")
