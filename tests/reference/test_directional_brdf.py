"""The reference's own lookup of measured materials."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.reference.directional_brdf import reflected
from renderer.reference.directional_world import Measured
from tests.reference.directional import unit

RNG = np.random.default_rng(11)


def directions(count: int = 500) -> np.ndarray:
    found = unit(RNG.normal(size=(count, 3)))
    found[:, 2] = np.abs(found[:, 2])
    return found


def angles(of: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return np.arccos(of[:, 2]), np.arctan2(of[:, 1], of[:, 0]) % (2 * np.pi)


def bent(phi: np.ndarray, count: int) -> np.ndarray:
    """A function of the azimuth that is straight between so many equal nodes."""
    ring = np.linspace(0, 2 * np.pi, count + 1)
    return np.asarray(np.interp(phi, ring, np.cos(ring)))


def table(to: int = 5, po: int = 8, tl: int = 4, pl: int = 6) -> Measured:
    """What is straight in each angle, so that five bilinear interpolations hit it everywhere."""
    theta_o, theta_l = np.linspace(0, 1.5, to), np.linspace(0, 1.4, tl) ** 1.3
    phi_o, phi_l = (2 * np.pi * np.arange(n) / n for n in (po, pl))
    parts = (1 + theta_o, 2 + bent(phi_o, po), 3 - theta_l, 2 + bent(phi_l, pl))
    whole = np.einsum("a,b,c,d->abcd", *parts)
    values = np.stack([whole, 2 * whole, whole + 1], axis=-1)
    return Measured("angles", (theta_o, phi_o, theta_l, phi_l), values)


def test_five_bilinear_interpolations() -> None:
    eye, light = directions(), directions()
    (to, po), (tl, pl) = angles(eye), angles(light)
    horizon = table().nodes[2][-1]
    right = (1 + np.minimum(to, 1.5)) * (2 + bent(po, 8)) * (3 - np.minimum(tl, horizon)) * (2 + bent(pl, 6))
    found = reflected(table(), eye, light)
    assert found == pytest.approx(np.stack([right, 2 * right, right + 1], axis=1), rel=1e-12)
    for beyond in (to > 1.5, tl > horizon, po > 2 * np.pi * 7 / 8):
        assert beyond.any(), "clamped, and wrapped"


def test_eye_and_light_are_told_apart() -> None:
    eye, light = directions(), directions()
    assert np.abs(reflected(table(), eye, light) / reflected(table(), light, eye) - 1).max() > 0.3


def test_an_isotropic_table_counts_from_the_eyes_azimuth_to_the_lights() -> None:
    theta_o, theta_l, turn = np.linspace(0, 1.5, 4), np.linspace(0, 1.5, 5), 2 * np.pi * np.arange(7) / 7
    values = np.einsum("a,c,d->acd", 1 + theta_o, 2 + theta_l, 2 + np.sin(turn))[:, None, ..., None] * [1, 2, 3]
    whole = Measured("difference", (theta_o, np.zeros(1), theta_l, turn), values)
    eye, light = directions(), directions()
    (to, po), (tl, pl) = angles(eye), angles(light)
    ring = np.linspace(0, 2 * np.pi, 8)
    around = np.interp((pl - po) % (2 * np.pi), ring, np.sin(ring))
    right = (1 + np.minimum(to, 1.5)) * (2 + np.minimum(tl, 1.5)) * (2 + around)
    assert reflected(whole, eye, light) == pytest.approx(right[:, None] * [1, 2, 3], rel=1e-12)
    c, s = np.cos(0.7), np.sin(0.7)
    turned = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    assert reflected(whole, eye @ turned.T, light @ turned.T) == pytest.approx(reflected(whole, eye, light))


def test_below_the_horizon_is_the_horizon() -> None:
    eye = unit([[1.0, 2.0, -0.4], [-1.0, 0.3, -3.0], [0.0, 0.0, -1.0]])
    level = unit([[1.0, 2.0, 0.0], [-1.0, 0.3, 0.0], [1.0, 0.0, 0.0]])
    light = directions(3)
    assert reflected(table(), eye, light) == pytest.approx(reflected(table(), level, light))


def test_the_half_vectors_coordinates() -> None:
    """By the definitions, without a rotation: the angle of h to the normal and of the light to h, and the angle between
    the planes of (h, normal) and (h, light)."""
    root, theta_d = np.linspace(0, 1, 6), np.linspace(0, np.pi / 2, 5) ** 1.2
    phi_d = np.pi * np.arange(7) / 7
    values = np.einsum("a,c,d->acd", 1 + root, 2 + theta_d, 2 + np.sin(2 * phi_d))[:, None, ..., None] * [1, 2, 3]
    material = Measured("half", (root, np.zeros(1), theta_d, phi_d), values)
    eye, light = directions(), directions()
    half = unit(eye + light)
    h, d = np.arccos(half[:, 2]), np.arccos(np.sum(half * light, axis=1))
    # about h: the first axis away from the normal, as a rotated x axis is
    first = unit(half * half[:, 2:] - [0, 0, 1])
    second = np.cross(half, first)
    p = np.arctan2(np.sum(light * second, axis=1), np.sum(light * first, axis=1)) % np.pi
    around = np.interp(p, np.append(phi_d, np.pi), np.append(np.sin(2 * phi_d), 0))
    right = (1 + np.sqrt(h / (np.pi / 2))) * (2 + np.minimum(d, theta_d[-1])) * (2 + around)
    found = reflected(material, eye, light)
    assert found == pytest.approx(right[:, None] * [1, 2, 3], rel=1e-9)
    assert reflected(material, light, eye) == pytest.approx(found, rel=1e-9), "reciprocal"
    assert reflected(material, eye * [-1, -1, 1], light * [-1, -1, 1]) == pytest.approx(found, rel=1e-9), "isotropic"
