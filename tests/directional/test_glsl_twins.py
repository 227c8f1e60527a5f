"""Hemispheres, frames and faces are the same in GLSL as in numpy."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from renderer.directional.casting import face_frame, face_middles
from renderer.directional.frames import decoded, encoded, frames
from renderer.directional.hemisphere import hemisphere_of
from renderer.gl.probe import probe
from renderer.gl.thread import GLThread

HEMISPHERE = ["directional/hemisphere.glsl"]


def _evaluated(thread: GLThread, *arguments: Any, **named: Any) -> np.ndarray:
    return thread.call(lambda gl: probe(gl, *arguments, **named))


def _directions(count: int = 4000) -> np.ndarray:
    drawn = np.random.default_rng(11).normal(size=(count, 3))
    drawn[:, 2] = np.abs(drawn[:, 2])
    return np.asarray(drawn / np.linalg.norm(drawn, axis=1, keepdims=True), np.float32)


@pytest.mark.parametrize("count", [129, 2049])
def test_directions_are_found_alike(thread: GLThread, count: int) -> None:
    layout, directions = hemisphere_of(count), _directions()
    body = f"hemisphere_nearest(direction, {layout.azimuths}, {layout.elevations})"
    found = _evaluated(thread, HEMISPHERE, body, {"direction": directions}, dtype="i4")[:, 0]
    wrong = found != layout.nearest(directions.astype(np.float64))
    assert wrong.mean() < 0.002  # on a border float32 may fall on the other side
    cosines = (layout.directions()[found[wrong]] * directions[wrong]).sum(axis=1)
    assert (cosines > np.cos(1.01 * layout.step)).all()


@pytest.mark.parametrize("count", [129, 513])
def test_each_number_is_the_direction_it_names(thread: GLThread, count: int) -> None:
    layout = hemisphere_of(count)
    body = f"hemisphere_direction(number, {layout.azimuths}, {layout.elevations})"
    found = _evaluated(thread, HEMISPHERE, body, {"number": np.arange(count, dtype=np.int32)}, 3)
    np.testing.assert_allclose(found, layout.directions(), atol=2e-6)


def _around(thread: GLThread, directions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    body = "ivec4 around; vec4 weights; hemisphere_around(direction, 16, 8, around, weights);"
    numbers = _evaluated(thread, HEMISPHERE, body + " result = vec4(around);", {"direction": directions}, 4)
    weights = _evaluated(thread, HEMISPHERE, body + " result = weights;", {"direction": directions}, 4)
    return numbers.astype(int), weights


def test_the_four_round_a_direction_bring_its_place_back(thread: GLThread) -> None:
    """What is bilinear in row and azimuth is reproduced; the mean of the four leans to the direction."""
    layout, directions = hemisphere_of(129), _directions()
    numbers, weights = _around(thread, directions)
    np.testing.assert_allclose(weights.sum(axis=1), 1, atol=1e-5)
    assert weights.min() >= -1e-5
    rows = np.append(np.repeat(np.arange(8), 16), 8)[numbers]
    elevation = np.arcsin(np.clip(directions[:, 2].astype(np.float64), 0, 1))
    np.testing.assert_allclose((rows * weights).sum(axis=1), np.clip(elevation / layout.step - 0.5, 0, 8), atol=1e-4)


def test_at_a_direction_itself_it_alone_counts(thread: GLThread) -> None:
    layout = hemisphere_of(129)
    numbers, weights = _around(thread, layout.directions().astype(np.float32))
    own = (weights * (numbers == np.arange(129)[:, None])).sum(axis=1)
    np.testing.assert_allclose(own, 1, atol=1e-4)


def test_frames_and_normals_are_alike(thread: GLThread) -> None:
    normals = _directions() * np.where(np.arange(4000) % 2, 1, -1)[:, None]
    codes = encoded(normals.astype(np.float64))
    files = ["directional/frames.glsl"]
    found = _evaluated(thread, files, "normal_of(code)", {"code": codes}, 3)
    np.testing.assert_allclose(found, decoded(codes), atol=2e-6)
    exact = decoded(codes)
    for column, axis in enumerate(frames(exact)):
        turned = _evaluated(thread, files, f"frame_of(normal)[{column}]", {"normal": exact.astype(np.float32)}, 3)
        np.testing.assert_allclose(turned, axis, atol=3e-5)


FACES = ["directional/hemisphere.glsl", "directional/frames.glsl", "directional/surfel.glsl", "directional/faces.glsl"]
BOX = np.array([[-0.5, -0.7, -0.9], [0.5, 0.7, 0.9]])


def _on_faces(thread: GLThread, body: str, inputs: dict[str, np.ndarray], outputs: int) -> np.ndarray:
    names = "uniform vec3 box_low; uniform vec3 box_high; uniform usampler2D surfels; uniform usampler2D shadow_code;"
    names += " uniform usampler2DArray seen; uniform usampler2DArray seen_depth; uniform isampler2D seen_layer;"
    return _evaluated(
        thread,
        FACES,
        body,
        inputs,
        outputs,
        declarations=names,
        defines={"TEXELS": 8, "SHADOW_BLOCKS": 1},
        uniforms={"box_low": BOX[0], "box_high": BOX[1]},
    )


def test_faces_are_alike(thread: GLThread) -> None:
    directions = _directions(600)
    for face in range(6):
        local = _on_faces(thread, f"to_face({face}, direction)", {"direction": directions}, 3)
        np.testing.assert_allclose(local, directions @ face_frame(face).T, atol=1e-6)
        at = np.stack(np.meshgrid((np.arange(8) + 0.5) / 8, (np.arange(8) + 0.5) / 8), axis=-1).reshape(-1, 2)
        places = _on_faces(thread, f"face_place({face}, at)", {"at": at.astype(np.float32)}, 3)
        np.testing.assert_allclose(places, face_middles(BOX, face, 8), atol=1e-6)
        back = _on_faces(thread, f"face_coordinates({face}, place)", {"place": places}, 2)
        np.testing.assert_allclose(back, at, atol=1e-6)


def test_rays_come_in_where_the_box_begins(thread: GLThread) -> None:
    towards = np.random.default_rng(2).uniform(-0.45, 0.45, (500, 3))
    origins = _directions(500).astype(np.float64) * 4 * np.where(np.arange(500) % 2, 1, -1)[:, None]
    ray = towards - origins
    ray /= np.linalg.norm(ray, axis=1, keepdims=True)
    body = "Entry entry = box_entry(origin, ray); result = vec4(entry.place, float(entry.face));"
    inputs = {"origin": origins.astype(np.float32), "ray": ray.astype(np.float32)}
    found = _on_faces(thread, body, inputs, 4)
    at = np.sort((BOX - origins[:, None]) / ray[:, None], axis=1)
    near = at[:, 0].max(axis=1)
    np.testing.assert_allclose(found[:, :3], origins + near[:, None] * ray, atol=1e-5)
    axis = at[:, 0].argmax(axis=1)
    assert (found[:, 3] == 2 * axis + (ray[np.arange(500), axis] < 0)).all()
    away = _on_faces(thread, body, {**inputs, "ray": -inputs["ray"]}, 4)
    assert (away[:, 3] == -1).all()


def test_a_row_that_is_cut_short_is_found(thread: GLThread, spoil: Callable) -> None:
    with spoil(
        "directional/hemisphere.glsl", "(float(elevations) + 0.5) / HALF_PI;\n", "float(elevations) / HALF_PI;\n"
    ):
        found = _evaluated(
            thread, HEMISPHERE, "hemisphere_nearest(direction, 16, 8)", {"direction": _directions()}, dtype="i4"
        )[:, 0]
    assert (found != hemisphere_of(129).nearest(_directions().astype(np.float64))).mean() > 0.05
