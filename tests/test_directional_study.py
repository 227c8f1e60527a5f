"""The study of the directional textures' pictures: which there are, what of them counts, and how it is told."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from renderer import directional_report as report
from renderer import directional_settings as settings
from renderer import directional_study as study
from renderer.core.baking import bake_now
from renderer.directional.bakes import bakes
from renderer.directional.casting import Caster
from renderer.directional.subject import knot
from renderer.directional_partial import Partial, layers_of
from renderer.session import Session
from renderer.world.camera import pose

SMALL = settings.Setting(16, 33, "position_corrected", shadow_directions=33, points=4000)


@pytest.fixture(scope="module")
def session() -> Iterator[Session]:
    with Session() as running:
        yield running


@pytest.fixture
def stage(session: Session, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[study.Stage]:
    monkeypatch.setattr(knot, "ALONG", 300)
    monkeypatch.setattr(knot, "AROUND", 24)
    # read here, and not by a worker that knows nothing of the smaller knot
    monkeypatch.setattr(session, "compute", lambda bake, *rest: bake_now(bake, session.cache))
    monkeypatch.setattr(study, "POSITIONS", 2)
    monkeypatch.setattr(study, "SIZE", 24)
    made = study.Stage(session, "knot", tmp_path / "results.jsonl", views=2, suns=1)
    yield made
    made.partial.close()


def test_views_look_at_the_box_from_all_sides() -> None:
    box = np.array([[-1.0, -2.0, 0.0], [1.0, 2.0, 3.0]])
    made = study.cameras(box)
    assert len(made) == study.VIEWS
    heights = np.sin(np.radians([camera["elevation"] for camera in made]))
    low, high = np.sin(np.radians([study.LOWEST, study.HIGHEST]))
    np.testing.assert_allclose(np.diff(heights), (high - low) / study.VIEWS, rtol=1e-2)
    turns = np.sort([camera["azimuth"] for camera in made])
    assert np.diff(turns, append=turns[0] + 360).max() < 3 * 360 / study.VIEWS
    # the box's ball just fits
    half = np.linalg.norm(box[1] - box[0]) / 2
    assert all(np.sin(np.radians(camera["field_of_view"] / 2)) * camera["distance"] == pytest.approx(half, rel=1e-5)
               and camera["target"] == [0, 0, 1.5] for camera in made)  # fmt: skip


def test_every_view_is_taken_once() -> None:
    assert sorted(study.sides(study.VIEWS)) == list(range(study.VIEWS))
    assert study.sides(3) == [0, 7, 14]


def test_a_setting_is_a_patch_of_the_document(session: Session) -> None:
    setting = settings.Setting(64, 129, "blended", "harmonics", 33, size=5, points=7000)
    state: Any = session.state(study.SCENE, "knot", setting.sets())
    assert (state.visibility.texels, state.visibility.directions, state.cloud.points) == (64, 129, 7000)
    assert (state.selection.kind, state.self_shadow.kind, state.self_shadow.size) == ("blended", "harmonics", 5)
    bits: Any = session.state(study.SCENE, "knot", replace(setting, code="bits", size=0, blend=False).sets())
    assert bits.self_shadow.blend is False
    assert len(set(settings.FACES)) == 27
    assert len(set(settings.CODES)) == len(settings.CODES)


def test_an_error_is_of_the_pixels_asked_for_relative_to_their_mean() -> None:
    right = np.ones((10, 20, 4)) * 2
    picture, mask = right.copy(), np.zeros((10, 20), bool)
    mask[:, :10] = True
    picture[:, 10:] += 9  # nobody asks for
    picture[0, 0, :3] += 4
    found = study.within(picture, right, mask)
    assert found["away"] == pytest.approx(np.sqrt(16 / 100) / 2)
    assert found["most"] == 0
    assert found["share"] == 0.5
    picture[1, :10, :3] -= 1
    assert study.within(picture, right, mask)["most"] == pytest.approx(np.sqrt(10 / 99) / 2)
    assert study.within(picture, right * 0, mask) == {"away": None, "most": None, "share": 0.0}


def test_a_part_of_the_faces_draws_what_all_of_them_do(stage: study.Stage, session: Session) -> None:
    """The same picture from all directions and from those alone that the camera needs."""
    state: Any = stage.state(SMALL, 3, "az180_el62")
    bare = state.model_copy(update={"view": state.view.model_copy(update={"background": "none"})})
    part = stage.partial.baked(bare)
    whole = {bake.name: bake_now(bake, session.cache) for bake in bakes(bare)}
    assert set(part) == set(whole)
    other = Partial(session)
    other.baked = lambda state: {name: replace(part[name], key=f"all {name}", arrays=arrays)  # type: ignore[method-assign]
                                 for name, arrays in whole.items()}  # fmt: skip
    try:
        one, two = (each.drawn(state, 24, 2).linear for each in (stage.partial, other))
    finally:
        other.close()
    assert one[..., 3].max() == 1
    np.testing.assert_array_equal(one, two)


@pytest.mark.parametrize("selection", settings.SELECTIONS)
def test_a_sum_over_points_is_the_picture(stage: study.Stage, selection: str) -> None:
    """Weights of a view and light of points give what drawing gives, and another sun needs no other weights."""
    for sun in ("az180_el62", "az120_el20"):
        state: Any = stage.state(replace(SMALL, selection=selection), 3, sun)
        drawn = stage.partial.drawn(state, 24, 2).linear
        found = stage.weighed.linear(state)
        assert drawn[..., 3].max() > 0.99
        np.testing.assert_allclose(found, drawn, rtol=0, atol=3e-5 * drawn.max())
        shares = stage.weighed.weights(state)
        shares.data[::7] *= 0.9
        assert np.abs(stage.weighed.linear(state) - drawn).max() > 1e-3 * drawn.max()
        shares.data[::7] /= 0.9
    assert (len(stage.weighed._weights), len(stage.weighed._lights)) == (1, 2)


def test_layers_that_no_pixel_needs_are_empty(stage: study.Stage, session: Session) -> None:
    state: Any = stage.state(replace(SMALL, directions=129), 3, "az180_el62")
    made = {bake.name: bake_now(bake, session.cache) for bake in bakes(state) if bake.name in ("subject", "cloud")}
    caster = Caster(made["subject"], made["cloud"])
    found = layers_of(state.camera, state.visibility, caster, len(made["cloud"]["position"]))
    sizes = np.diff(found["ends"], axis=1, prepend=0)
    eye = pose(state.camera).eye - found["box"].mean(axis=0)
    behind = [face for face in range(6) if (eye[face // 2] > 0) != bool(face % 2)]
    assert (sizes[behind] == sizes.min()).all()
    assert 0.02 < (sizes > sizes.min()).mean() < 0.5


def test_a_study_goes_on_where_it_was_and_leaves_its_table(
    stage: study.Stage, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    said: list[str] = []
    lines = stage.swept("chief", (SMALL, replace(SMALL, code="none")), lambda share, words: said.append(words))
    assert [(line["view"], line["code"]) for line in lines] == [(0, "bits"), (0, "none"), (7, "bits"), (7, "none")]
    assert all(0 < line["away"] < 3 and 0 < line["share"] < 0.5 for line in lines)
    monkeypatch.setattr(stage, "_picture", lambda *given: pytest.fail("drawn again"))
    assert stage.swept("chief", (SMALL,), lambda share, words: None) == lines[::2]
    text = report.write(tmp_path, [*lines, *({**line, "preset": "land", "away": 0.125} for line in lines[:1])])
    assert all((tmp_path / name).stat().st_size > 0 for name in report.FILES)
    rows = [line for line in text.splitlines() if line.startswith("| 16 | 33 | position_corrected | bits |")]
    assert len(rows) == 2, "one of each preset"
    cells, other = ([cell.strip() for cell in row.strip("|").split("|")] for row in rows)  # the knot, and the land
    assert (other[6], other[-1]) == ("0.125", "1")
    own = [line["away"] for line in lines[::2]]
    assert cells[6:8] == [f"{np.median(own):.3f}", f"{max(own):.3f}"]
    assert cells[-1] == "2"


def test_what_stands_before_the_subject_itself_does_not_count(stage: study.Stage) -> None:
    """A knot's strands cross: fewer pixels are away from these silhouettes than from the outline alone."""
    state: Any = stage.state(SMALL, 20, "az180_el62")
    alpha = stage.partial.drawn(state, 48, 2).linear[..., 3]
    mask = stage.away(state, alpha)
    outer = study.away(alpha, study.AWAY * stage.longest * 48)
    assert mask.any()
    assert (mask <= outer).all()
    assert mask.sum() < 0.8 * outer.sum()
