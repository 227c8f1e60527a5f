"""Motion by key frames: the poses of a document's key frames, computed at every moment or interpolated."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from renderer.core.baking import bake_key, bake_now
from renderer.core.cache import Cache
from renderer.core.errors import LimitError
from renderer.core.params import validate
from renderer.core.technique import BakedArrays
from renderer.shells import animation_frames
from renderer.shells.animation import Posed, Still, bent, deformed, motion_of, twisted
from renderer.shells.animation_frames import frame_error
from renderer.shells.animation_scene import Animator, moment
from renderer.shells.bakes import bakes
from renderer.shells.shell_bake import shell_of
from renderer.shells.state import ShellsState
from renderer.shells.surfaces import Tube

KEYS: list[dict[str, Any]] = [{"at": 3, "bend": 60, "twist": 90}, {"at": 0}, {"at": 5, "swell": 0.1}]
DOCUMENT: dict[str, Any] = {
    "scene": "shells",
    "surface": {"kind": "tube"},
    "course": {"period": 8, "keys": KEYS},
    "motion": {"kind": "keys"},
}


def state_of(**changes: Any) -> ShellsState:
    return validate(ShellsState, {**DOCUMENT, **changes})


def posed(**changes: Any) -> Posed:
    state = state_of(**changes)
    found = motion_of(state.motion, state.course)
    assert isinstance(found, Posed)
    return found


def test_poses_are_even_between_key_frames_and_come_round() -> None:
    mesh, motion = Tube(along=8).mesh(), posed()
    for time in (3.0, 11.0):
        turned = bent(twisted(mesh.vertices, np.pi / 2), np.pi / 3)
        np.testing.assert_allclose(deformed(mesh, motion, time), turned, atol=1e-12)
    np.testing.assert_allclose(deformed(mesh, motion, 0.0), mesh.vertices, atol=1e-12)
    half = deformed(mesh, motion, 6.5)
    np.testing.assert_allclose(np.hypot(half[:, 0], half[:, 1]), np.hypot(*mesh.vertices[:, :2].T) + 0.05, atol=1e-9)
    np.testing.assert_allclose(motion.at(1.5), (np.pi / 6, np.pi / 4, 0.0))


def test_key_frames_that_pose_nothing_keep_the_baked_shell() -> None:
    assert motion_of(state_of().motion, state_of(course={"keys": [{"growth": 0.5}]}).course) == Still()
    still = state_of(motion={"kind": "still"})
    assert motion_of(still.motion, still.course) == Still(), "poses move nothing that is said to stand still"


@pytest.fixture(scope="module")
def baked() -> dict[str, BakedArrays]:
    cache = Cache()
    return {bake.name: BakedArrays(bake_key(bake), bake_now(bake, cache)) for bake in bakes(state_of())}


def shells_at(baked: dict[str, BakedArrays], motion: Posed, time: float) -> tuple[Any, Any]:
    extrusion = state_of().extrusion
    found = Animator().at(baked["surface"], baked["shell"], extrusion, motion, time)
    right = moment(baked["surface"].arrays, baked["shell"].arrays, extrusion, motion, time)
    return shell_of(found.shell), shell_of(right.shell)


def test_interpolated_planes_are_exact_at_key_frames_and_near_between(baked: dict[str, BakedArrays]) -> None:
    motion = posed(motion={"kind": "keys", "planes": "interpolated"})
    for time in (0.0, 3.0, 5.0, 13.0):
        error = frame_error(*shells_at(baked, motion, time))
        assert max(error.texture_most, error.plane_most, error.place_most) < 1e-9, time
    rough = frame_error(*shells_at(baked, motion, 1.5))
    assert 0.01 < rough.plane < 0.1, "60 degrees of bend and 90 of twist from key frame to key frame are far too much"
    finer = [{"at": at, "bend": 20 * at, "twist": 30 * at} for at in (0, 0.75, 1.5 - 0.375, 1.5 + 0.375, 2.25, 3)]
    fine = posed(course={"period": 8, "keys": finer}, motion={"kind": "keys", "planes": "interpolated"})
    near = frame_error(*shells_at(baked, fine, 1.5))
    assert near.plane < rough.plane / 8, "a quarter of the distance: a sixteenth of the error"
    computed = frame_error(*shells_at(baked, posed(), 1.5))
    assert computed.texture_most < 1e-9


def test_more_key_frames_than_memory_are_refused(
    baked: dict[str, BakedArrays], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(animation_frames, "MOST_BYTES", 1000)
    with pytest.raises(LimitError, match="key frames") as refused:
        shells_at(baked, posed(motion={"kind": "keys", "planes": "interpolated"}), 1.0)
    assert refused.value.field == "course.keys"
