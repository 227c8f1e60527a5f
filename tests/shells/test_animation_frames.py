"""Key frames: exact at their own times, off in between by what halving their distance quarters."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.shells.animation import Bend, positions_at
from renderer.shells.animation_frames import KeyFrames, frame_error, key_frames
from renderer.shells.extrusion import Extrusion, directions
from renderer.shells.shell import Shell, build_shell, update_shell
from renderer.shells.surfaces import Tube

MESH, EXTRUSION, MOTION = Tube(around=16, along=12).mesh(), Extrusion(thickness=0.08), Bend(angle=60, period=6)
LENGTH = np.full(len(MESH.vertices), EXTRUSION.thickness)
SHELL = build_shell(MESH, LENGTH[:, None] * directions(MESH.vertices, MESH.faces, EXTRUSION)[0])


def places(time: float) -> np.ndarray:
    return positions_at(MESH, LENGTH, EXTRUSION, MOTION, time)


def exact_at(time: float) -> Shell:
    return update_shell(SHELL, places(time))[0]


def frames(count: int) -> KeyFrames:
    times = [MOTION.period * k / count for k in range(count)]
    return key_frames(SHELL, [places(time) for time in times], times, MOTION.period)


def test_a_key_frame_is_exact_at_its_own_time() -> None:
    kept = frames(8)
    for number in (0, 3, 7, 11):
        time = MOTION.period * number / 8
        error = frame_error(kept.at(time), exact_at(time))
        assert max(error.texture_most, error.plane_most, error.place_most) < 1e-9


def test_interpolation_errs_by_the_square_of_the_frames_distance() -> None:
    def at_middle(count: int) -> tuple[float, float, float]:
        time = MOTION.period * 1.5 / 64  # where the motion is fast, and always in the middle between two frames
        start = time - MOTION.period / count / 2
        between = KeyFrames((exact_at(start), exact_at(start + MOTION.period / count)), (0.0, 1.0), 2.0).at(0.5)
        error = frame_error(between, exact_at(time))
        return float(error.texture[2]), error.plane, error.place

    coarse, fine = at_middle(16), at_middle(32)
    assert coarse[0] > 0.003
    np.testing.assert_allclose(np.array(coarse) / fine, 4, rtol=0.2)


def test_computed_planes_fit_interpolated_vertices() -> None:
    """What survives: vertices interpolated, planes and maps computed from them, err by their place alone."""
    kept, time = frames(16), MOTION.period * 1.5 / 16
    exact = exact_at(time)
    between = kept.at(time)
    computed, _ = update_shell(SHELL, between.positions)
    assert frame_error(between, exact).texture_most > 0.05
    assert frame_error(computed, exact).texture_most < 1e-9
    assert frame_error(computed, exact).place == frame_error(between, exact).place


def test_normals_stay_unit_vectors_and_bytes_are_counted() -> None:
    kept = frames(8)
    np.testing.assert_allclose(np.linalg.norm(kept.at(1.0).planes[..., :3], axis=-1), 1)
    one = SHELL.positions.nbytes + SHELL.planes.nbytes + SHELL.to_texture.nbytes
    assert kept.nbytes == 8 * one == pytest.approx(8 * 8 * (28 * len(SHELL.tets) + SHELL.positions.size))
