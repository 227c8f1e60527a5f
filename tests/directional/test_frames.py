"""Frames are square and right-handed everywhere, and normals survive their codes."""

from __future__ import annotations

import numpy as np

from renderer.directional.frames import decoded, encoded, frames, quantised


def _normals() -> np.ndarray:
    drawn = np.random.default_rng(5).normal(size=(2000, 3))
    special = [[0, 0, 1], [0, 0, -1], [1, 0, 0], [0, -1, 0], [0, 1e-9, -1], [1e-9, 0, 1]]
    both = np.concatenate([drawn, special])
    return np.asarray(both / np.linalg.norm(both, axis=1, keepdims=True))


def test_frames_are_square_and_right_handed_poles_included() -> None:
    normals = _normals()
    tangents, bitangents = frames(normals)
    matrices = np.stack([tangents, bitangents, normals], axis=1)
    square = matrices @ matrices.transpose(0, 2, 1)
    np.testing.assert_allclose(square, np.broadcast_to(np.eye(3), square.shape), atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(matrices), 1, atol=1e-12)


def test_the_printed_frame_is_not_square_by_the_angles_of_the_brdf() -> None:
    theta, phi = np.radians(40.0), 0.3  # errata 003-3

    def turned(azimuth: float) -> np.ndarray:
        return np.array([np.sin(theta) * np.cos(azimuth), np.sin(theta) * np.sin(azimuth), np.cos(theta)])

    assert abs(turned(phi) @ turned(phi + np.pi / 2) - np.cos(theta) ** 2) < 1e-12
    assert np.cos(theta) ** 2 > 0.58


def test_normals_survive_sixteen_bits() -> None:
    normals = _normals()
    cosine = (quantised(normals) * normals).sum(axis=1)
    assert np.degrees(np.arccos(np.clip(cosine, -1, 1))).max() < 0.005
    codes = encoded(normals)
    assert (encoded(decoded(codes)) == codes).mean() > 0.99
