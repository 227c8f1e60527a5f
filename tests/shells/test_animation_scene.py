"""A scene in motion: the same at a moment whatever came before, and only what changed is named."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from renderer.core.params import bake_arguments
from renderer.core.technique import BakedArrays
from renderer.gl.context import GL
from renderer.gl.thread import GLThread
from renderer.shells.animation import MOVING, Bend, Bump, Still
from renderer.shells.animation_scene import Animator, moment
from renderer.shells.extrusion import Extrusion
from renderer.shells.following import Following
from renderer.shells.probe import crossings
from renderer.shells.resident import tet_texels
from renderer.shells.shell_bake import bake_shell
from renderer.shells.surfaces import Sphere, bake_surface
from renderer.world.camera import Orbit, rays
from tests.shells.conftest import even, sigma

Draw = Callable[..., np.ndarray]
EXTRUSION = Extrusion(thickness=0.05)
SURFACE = bake_surface(bake_arguments(Sphere(divisions=6)), {}, lambda *_: None)
SHELL = bake_shell(bake_arguments(EXTRUSION), {"surface": SURFACE}, lambda *_: None)
BAKED = BakedArrays("surface", SURFACE), BakedArrays("shell", SHELL)


def test_a_moment_does_not_depend_on_those_before() -> None:
    animator = Animator()
    for motion, time in ((Bump(), 0.3), (Bump(), 0.4), (Bend(), 1.0), (Bump(), 0.5)):
        followed = animator.at(*BAKED, EXTRUSION, motion, time)
        alone = moment(SURFACE, SHELL, EXTRUSION, motion, time)
        for name in MOVING:
            np.testing.assert_array_equal(followed.shell[name], alone.shell[name])
        for name in ("vertices", "normals"):
            np.testing.assert_array_equal(followed.surface[name], alone.surface[name])


def test_what_changed_is_named_and_nothing_is_done_twice() -> None:
    animator = Animator()
    first = animator.at(*BAKED, EXTRUSION, Bump(), 0.3)
    assert first.changed is None, "of the first moment all may be new"
    again = animator.at(*BAKED, EXTRUSION, Bump(), 0.3)
    assert again is first
    later = animator.at(*BAKED, EXTRUSION, Bump(), 0.4)
    assert later.changed is not None
    assert 0 < len(later.changed) < 0.4 * len(SHELL["tets"])
    differs = (later.shell["planes"] != first.shell["planes"]).any(axis=(1, 2))
    assert np.isin(np.flatnonzero(differs), later.changed).all()
    assert len({first.key, later.key}) == 2


def test_between_key_frames_planes_err_by_less_the_more_there_are() -> None:
    """At a key frame by nothing; and who goes back to moments that are computed has them to the last bit."""
    animator = Animator()
    exact = moment(SURFACE, SHELL, EXTRUSION, Bend(), 1.6).shell["planes"]
    errors = []
    for count in (8, 32):
        at_key = animator.at(*BAKED, EXTRUSION, Bend(frames=count), 1.5)
        np.testing.assert_allclose(
            at_key.shell["planes"], moment(SURFACE, SHELL, EXTRUSION, Bend(), 1.5).shell["planes"], atol=1e-12
        )
        between = animator.at(*BAKED, EXTRUSION, Bend(frames=count), 1.6)
        assert between.changed is None
        errors.append(abs(between.shell["planes"] - exact).max())
    assert 0 < 4 * errors[1] < errors[0] < 0.2
    np.testing.assert_array_equal(animator.at(*BAKED, EXTRUSION, Bend(), 1.6).shell["planes"], exact)


def test_the_gpu_is_written_what_moved_and_holds_what_it_would_from_scratch(thread: GLThread) -> None:
    def check(gl: GL) -> list[int]:
        written, animator = [], Animator()
        kept = Following(gl, "kept", SHELL, base=True)
        for motion, time in ((Bump(), 0.3), (Bump(), 0.4), (Bump(), 0.4), (Bump(), 0.5), (Bend(), 0.5)):
            now = animator.at(*BAKED, EXTRUSION, motion, time)
            objects, place = kept.at(now)
            fresh = Following(gl, "fresh", SHELL, base=True)
            others, _ = fresh.at(now)
            for name in ("shell_tets", "shell_base"):
                assert objects[name].read() == others[name].read(), name
            assert objects["entries"].read() == others["entries"].read()
            np.testing.assert_allclose(
                np.frombuffer(objects["shell_tets"].read(), np.float32).reshape(-1, 8, 4)[: len(SHELL["tets"])],
                tet_texels(now.shell, place.centre).reshape(-1, 8, 4)[: len(SHELL["tets"])], atol=1e-6,
            )
            fresh.release()
            written.append(kept.written)
        kept.release()
        return written

    cells = len(SHELL["tets"])
    first, second, again, third, other = thread.call(check)
    assert first == cells
    assert 0 < second == again < 0.4 * cells, "what is shown already is not written again"
    assert 0 < third < 0.4 * cells
    assert other == cells


def test_what_stands_still_is_the_bake_itself() -> None:
    still = Animator().at(*BAKED, EXTRUSION, Still(), 7.0)
    assert still.shell is SHELL
    assert still.key == "shell"
    assert moment(SURFACE, SHELL, EXTRUSION, Still(), 7.0).surface is SURFACE


def test_the_picture_follows(draw: Draw) -> None:
    """Opacities of an even absorber over a bumped, hollow ball are those of the ways through its cells at that time."""
    bump = {"kind": "bump", "height": 0.15, "radius": 0.5, "period": 8.0}
    camera = {"kind": "orbit", "target": [0, 0, 0], "distance": 3, "azimuth": 60, "elevation": 9, "field_of_view": 40}
    scene = {"surface": {"kind": "sphere", "divisions": 6}, "extrusion": {"thickness": 0.05}, "camera": camera}
    size = 12
    still = draw(scene, even(0.05), size=size)[..., 3]
    for time in (0.5, 1.0):
        moved = draw({**scene, "motion": bump, "time": time}, even(0.05), size=size)[..., 3]
        planes = moment(SURFACE, SHELL, EXTRUSION, Bump(**bump), time).shell["planes"]
        ways = np.stack(rays(Orbit(**camera), size, size), axis=2).reshape(-1, 2, 3)
        near, far = np.moveaxis([crossings(planes, *way) for way in ways], 1, 0)
        length = np.where(far > near, far - near, 0.0).sum(axis=1).reshape(size, size)
        expected = 1 - np.exp(-sigma(0.05) * length)
        assert abs(moved - expected).max() < 5e-4
        assert abs(still - expected).max() > 0.01
