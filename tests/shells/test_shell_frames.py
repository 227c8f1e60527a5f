"""Tangent frames: along the texture, orthonormal, and finite where the texture says nothing."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.shells.base_mesh import BaseMesh
from renderer.shells.shell_frames import any_tangent, tangent_frames
from renderer.shells.surfaces import Plane, Tube
from tests.shells.meshes import ALL, smeared, torus


@pytest.mark.parametrize("name", ALL)
def test_frames_are_orthonormal(name: str) -> None:
    frames = tangent_frames(ALL[name])
    axes = np.stack([frames.tangent, frames.binormal, frames.normal], axis=-2)
    np.testing.assert_allclose(axes @ np.swapaxes(axes, -1, -2), np.broadcast_to(np.eye(3), axes.shape), atol=1e-9)


def test_a_planes_frame_is_that_of_its_texture() -> None:
    flat = Plane(repeat_u=3).mesh()
    frames = tangent_frames(flat)
    np.testing.assert_allclose(frames.tangent, np.broadcast_to((1, 0, 0), frames.tangent.shape), atol=1e-12)
    np.testing.assert_allclose(frames.binormal, np.broadcast_to((0, 1, 0), frames.tangent.shape), atol=1e-12)
    leaning = BaseMesh(flat.vertices, flat.faces, flat.corner_uv @ np.array([[1.0, 0.0], [-1.0, 1.0]]))
    # u = 1.5 x - y: where it grows with v = y fixed is along x, still.
    np.testing.assert_allclose(tangent_frames(leaning).tangent[..., 0], 1)


def test_v_grows_along_the_binormal_of_a_mirrored_texture_too() -> None:
    flat = Plane().mesh()
    for factor in ((-1, 1), (1, -1), (-1, -1)):
        frames = tangent_frames(BaseMesh(flat.vertices, flat.faces, flat.corner_uv * factor))
        np.testing.assert_allclose(frames.tangent[..., 0], factor[0])
        np.testing.assert_allclose(frames.binormal[..., 1], factor[1])


@pytest.mark.parametrize("mesh", [Tube(around=48, along=9).mesh(), torus(around=64, across=40)], ids=["tube", "torus"])
def test_u_runs_around_the_axis(mesh: BaseMesh) -> None:
    frames = tangent_frames(mesh)
    x, y, _ = np.moveaxis(mesh.vertices[mesh.faces], -1, 0)
    around = np.stack([-y, x, np.zeros_like(x)], axis=-1) / np.hypot(x, y)[..., None]
    assert np.einsum("fck,fck->fc", frames.tangent, around).min() > 0.99


def test_texture_without_area_is_told_and_harmless() -> None:
    frames = tangent_frames(smeared())
    np.testing.assert_array_equal(frames.guessed, np.arange(16))
    assert np.isfinite(frames.tangent).all()
    np.testing.assert_allclose(frames.tangent[16:, :, 0], 1)


def test_a_tangent_is_found_for_every_normal() -> None:
    normal = np.random.default_rng(1).normal(size=(500, 3))
    normal = np.concatenate([normal / np.linalg.norm(normal, axis=1, keepdims=True), np.eye(3), -np.eye(3)])
    found = any_tangent(normal)
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1)
    np.testing.assert_allclose(np.einsum("nk,nk->n", found, normal), 0, atol=1e-12)
