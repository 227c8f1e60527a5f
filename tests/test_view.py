"""Views: each its own mean, the same pixels as a rendered picture, and one spoiled shader spoils nothing else."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from renderer.core.cache import AssetStore, Cache
from renderer.core.errors import ShaderError, UmbrageError
from renderer.forest import program
from renderer.gl import source
from renderer.session import Frame, Session, View
from renderer.world.image import display
from tests.forest import worlds
from tests.test_session import furnish

CAMERA = {"kind": "orbit", "target": [0, 0, 5], "distance": 60, "azimuth": 30, "elevation": 25, "field_of_view": 40}


@pytest.fixture(scope="module")
def session(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Session]:
    cache = Cache(tmp_path_factory.mktemp("cache"))
    with Session(cache, assets=AssetStore(tmp_path_factory.mktemp("assets"))) as opened:
        furnish(cache, opened.state("forest", document=worlds.PLAIN))
        opened.prepare(state(opened)).future.result(60)
        yield opened


@pytest.fixture
def view(session: Session) -> Iterator[View]:
    opened = session.view()
    yield opened
    opened.close()


def state(session: Session, n: int = 4, **patch: Any) -> Any:
    quality = {"kind": "samples", "n": n}
    return session.state("forest", document={"camera": CAMERA, "quality": quality, **worlds.PLAIN, **patch})


def draw(view: View, of: Any, more: int = 1, size: tuple[int, int] = (32, 24)) -> Frame:
    return view.frame(of, *size, more).result(60)


def test_frames_add_up_to_the_very_pixels_of_a_picture(session: Session, view: View) -> None:
    for n, steps in ((1, [1]), (4, [1, 1, 1, 1]), (5, [2, 2, 2]), (6, [6])):
        of = state(session, n, sun=worlds.sun(100 + n, 40))
        for more in steps:
            frame = draw(view, of, more)
        picture = session.render(of, 32, 24)
        assert frame.samples == picture.samples == n
        np.testing.assert_array_equal(frame.rgb8, picture.rgb8)


def test_a_mean_that_skipped_a_sample_would_differ(session: Session, view: View) -> None:
    of = state(session, 3)
    assert (draw(view, of, 2).rgb8 != session.render(of, 32, 24).rgb8).any()


def test_samples_are_counted_to_the_end(session: Session, view: View) -> None:
    of = state(session, 3)
    seen = [draw(view, of, 2) for _ in range(3)]
    assert [frame.samples for frame in seen] == [2, 3, 3]
    assert [frame.converged for frame in seen] == [False, True, True]
    assert seen[0].target_samples == 3
    np.testing.assert_array_equal(seen[1].rgb8, seen[2].rgb8)
    assert "Ray marching" in seen[0].technique


def test_two_views_never_share_a_mean(session: Session) -> None:
    first, second = session.view(), session.view()
    one, other = state(session), state(session, camera={**CAMERA, "azimuth": 200, "distance": 90})
    alone = session.render(one, 32, 24).rgb8, session.render(other, 32, 24).rgb8
    assert (alone[0] != alone[1]).any()
    for _ in range(4):
        seen = draw(first, one), draw(second, other)
    for frame, expected in zip(seen, alone, strict=True):
        assert frame.samples == 4
        np.testing.assert_array_equal(frame.rgb8, expected)
    first.close()
    second.close()


@pytest.mark.parametrize("patch", [
    {"sun": worlds.sun(10, 10)},
    {"camera": {**CAMERA, "distance": 61}},
    {"ground": {"albedo": [0.5, 0.5, 0.5]}},
    {"light": worlds.technique("light", "gouraud")},
])
def test_another_state_starts_afresh(session: Session, view: View, patch: dict[str, Any]) -> None:
    draw(view, state(session), 3)
    frame = draw(view, state(session, **patch))
    assert frame.samples == 1
    np.testing.assert_array_equal(frame.rgb8, session.render(state(session, 1, **patch), 32, 24).rgb8)


def test_another_size_starts_afresh(session: Session, view: View) -> None:
    draw(view, state(session), 3)
    frame = draw(view, state(session), size=(20, 24))
    assert (frame.samples, frame.width, frame.height) == (1, 20, 24)
    assert frame.rgb8.shape == (24, 20, 3)


def test_exposure_and_quality_keep_the_samples(session: Session, view: View) -> None:
    draw(view, state(session, 4, view={"exposure": 0.0}), 3)
    brighter = draw(view, state(session, 4, view={"exposure": 2.0}))
    assert brighter.samples == 4
    np.testing.assert_array_equal(brighter.rgb8, session.render(state(session, 4, view={"exposure": 2.0}), 32, 24).rgb8)
    assert draw(view, state(session, 8, view={"exposure": 2.0})).samples == 5
    fixed = {"exposure": 2.0, "auto_exposure": False}
    assert draw(view, state(session, 8, view=fixed)).samples == 6
    # Fewer than it has: they are not in the sum on their own any more.
    assert draw(view, state(session, 2, view={"exposure": 2.0})).samples == 1


def test_the_exposure_follows_the_sun_unless_it_is_fixed(session: Session) -> None:
    """A sinking sun is metered; the pixels are those of the radiance at the exposure that the picture names."""
    stops = {}
    for followed in (True, False):
        for degrees in (60, 4):
            view = {"auto_exposure": followed, "exposure": 0.5, "background": "none"}
            picture = session.render(state(session, 2, sun=worlds.sun(200, degrees), view=view), 32, 24)
            stops[followed, degrees] = picture.meta["exposure_ev"]
            twin = display(picture.linear, picture.meta["exposure_ev"])
            assert np.abs(picture.rgb8.astype(int) - twin).max() <= 1
    assert stops[False, 4] == stops[False, 60]
    assert stops[True, 4] > stops[True, 60] + 0.3


def test_the_newest_state_wins(session: Session, view: View) -> None:
    holding, begun = threading.Event(), threading.Event()

    def hold(gl: Any) -> None:
        begun.set()
        holding.wait(60)

    busy = session.gl.submit(hold)
    begun.wait(60)
    asked = [view.frame(state(session, sun=worlds.sun(azimuth, 30)), 16, 16) for azimuth in (10, 20, 30)]
    holding.set()
    busy.result(60)
    newest = asked[-1].result(60)
    assert [future.cancelled() for future in asked] == [True, True, False]
    np.testing.assert_array_equal(newest.rgb8, session.render(state(session, 1, sun=worlds.sun(30, 30)), 16, 16).rgb8)


def test_a_point_is_told_with_its_radiance(session: Session, view: View) -> None:
    of = state(session)
    draw(view, of, 4)
    facts = view.probe(of, 0.5, 0.9).result(60)
    linear = session.render(of, 32, 24).linear
    assert facts["radiance"] == pytest.approx(linear[21, 16, :3].tolist())


def test_a_state_that_is_not_baked_is_refused_in_words(session: Session, view: View) -> None:
    with pytest.raises(UmbrageError, match="prepare"):
        draw(view, state(session, canopy={"seed": 77}))
    assert draw(view, state(session)).samples == 1


def test_a_failing_shader_tells_its_line_and_the_view_goes_on(
    session: Session, view: View, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not only the error: what was shown before, and what comes after, are whole pictures."""
    good = draw(view, state(session), 4)
    file, read = "forest/light/gouraud.glsl", source._read

    def spoiled(root: Any, name: str) -> Any:
        raw, clean = read(root, name)
        if name != file:
            return raw, clean
        return tuple(line.replace("mix(1.0", "mixed(1.0") for line in raw), clean

    bad = state(session, light=worlds.technique("light", "gouraud", strength=0.37))
    with monkeypatch.context() as patch:
        patch.setattr(source, "_read", spoiled)
        program._composed.cache_clear()
        with pytest.raises(ShaderError) as failure:
            draw(view, bad)
    program._composed.cache_clear()
    lines = (source.SHADERS / file).read_text().split("\n")
    assert failure.value.file == file
    assert "mix(1.0" in lines[failure.value.line - 1]
    again = draw(view, state(session), 4)
    np.testing.assert_array_equal(again.rgb8, good.rgb8)
    np.testing.assert_array_equal(draw(view, bad, 4).rgb8, session.render(bad, 32, 24).rgb8)


def test_a_closed_view_frees_its_canvas(session: Session) -> None:
    before = session.gl.live_objects()
    opened = session.view()
    draw(opened, state(session))
    assert session.gl.live_objects() > before
    opened.close()
    draw(other := session.view(), state(session))
    other.close()
    assert session.gl.live_objects() == before
