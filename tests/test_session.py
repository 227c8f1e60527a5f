"""The session: documents in, checked and described; bakes prepared; pictures out; nothing left behind."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from renderer.core.baking import bake_key
from renderer.core.cache import AssetStore, Cache
from renderer.core.errors import Cancelled, InputError, InvalidDocument, LimitError, UmbrageError
from renderer.forest.bakes import bakes, ground_bake
from renderer.session import Session
from tests.forest import worlds

SMALL = {"quality": {"kind": "samples", "n": 2}, **worlds.PLAIN}


def furnish(cache: Cache, state: Any) -> None:
    """Put hand-made bakes where the session looks for the state's own."""
    dark = {"coefficients": np.zeros((8, 16, 16, 16), np.float32), "basis": np.zeros((32, 10, 16), np.float32)}
    made: dict[str, Any] = {
        "sky": worlds.sky((0.2, 0.3, 0.5)), "terrain": worlds.ground(), "pattern": worlds.uniform(40),
        "transmittance": dark,
    }
    for bake in bakes(state):
        cache.put(bake_key(bake), made[bake.name])


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Cache:
    return Cache(tmp_path_factory.mktemp("cache"))


@pytest.fixture(scope="module")
def session(cache: Cache, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Session]:
    with Session(cache, assets=AssetStore(tmp_path_factory.mktemp("assets"))) as opened:
        furnish(cache, opened.state("forest"))
        yield opened


def test_scenes_and_their_presets_are_listed(session: Session) -> None:
    (forest,) = [scene for scene in session.scenes() if scene["name"] == "forest"]
    assert forest["title"]
    assert {"noon", "low_sun", "valley_sunset", "forest_edge"} <= {preset["name"] for preset in forest["presets"]}


def test_a_description_is_json_and_holds_valid_documents(session: Session) -> None:
    found = json.loads(json.dumps(session.describe("forest"), allow_nan=False))
    assert session.validate(found["defaults"]) == session.state("forest")
    for name, preset in found["presets"].items():
        assert session.validate(preset["document"]) == session.state("forest", name)
    slots = {slot["name"]: slot for slot in found["slots"]}
    for name, slot in slots.items():
        kinds = [technique["kind"] for technique in slot["techniques"]]
        assert slot["default"] in kinds
        assert name in found["schema"]["properties"]
        for technique in slot["techniques"]:
            assert technique["available"] is not bool(technique["why_not"])


@pytest.mark.parametrize(("arguments", "field"), [
    ({"scene": "tundra"}, "scene"),
    ({"scene": "forest", "preset": "midnight"}, "preset"),
    ({"scene": "forest", "sets": {"shadow.strength": "soft"}}, "shadow.strength"),
    ({"scene": "forest", "sets": {"shadow.kind": "magic"}}, "shadow.kind"),
    ({"scene": "forest", "sets": {"sun.elevation": float("nan")}}, "sun.elevation"),
    ({"scene": "forest", "sets": {"..": 1}}, ".."),
    ({"scene": "forest", "document": {"wind": 1}}, "wind"),
    ({"scene": "forest", "document": {"version": 99}}, "version"),
    ({"scene": "forest", "document": {"camera": {"kind": "orbit", "distance": -3}}}, "camera.distance"),
])
def test_what_is_wrong_with_a_state_is_named(session: Session, arguments: dict[str, Any], field: str) -> None:
    with pytest.raises((InputError, InvalidDocument)) as refused:
        session.state(**arguments)
    failure = refused.value
    assert field in ([error.field for error in failure.errors] if isinstance(failure, InvalidDocument)
                     else [failure.field])


@pytest.mark.parametrize("document", [None, [], "forest", {}, {"scene": 3}, {"scene": "tundra"}])
def test_no_document_of_a_scene_is_refused_in_words(session: Session, document: Any) -> None:
    with pytest.raises(InputError):
        session.validate(document)


def test_documents_merge_over_presets_and_values_over_documents(session: Session) -> None:
    made: Any = session.state("forest", "noon", {"sun.elevation": 5.0},
                              {"sun": {"azimuth": 77.0, "elevation": 9.0}, "shadow": {"kind": "none"}})
    assert (made.sun.azimuth, made.sun.elevation) == (77, 5)
    assert made.shadow.kind == "none"
    assert made.camera == session.state("forest", "noon").camera


def test_a_document_without_a_version_is_of_the_first(session: Session) -> None:
    document = session.state("forest", "noon").model_dump(mode="json")
    del document["version"]
    assert session.validate(document) == session.state("forest", "noon")


def test_what_is_cached_costs_nothing_and_is_prepared_once(session: Session) -> None:
    state = session.state("forest", sets={"sun.azimuth": 12.0})
    assert session.expected_seconds(state) == 0
    session.prepare(state).future.result(60)
    assert session.prepared(state)
    # Only the light differs: nothing more is needed.
    assert session.prepared(session.state("forest", sets={"sun.elevation": 50.0}))
    unbaked = session.state("forest", sets={"cover.seed": 1234})
    assert not session.prepared(unbaked)
    assert session.expected_seconds(unbaked) > 0


def test_a_picture_is_what_its_quality_says(session: Session) -> None:
    for quality, samples in (({"kind": "draft"}, 1), ({"kind": "samples", "n": 3}, 3)):
        seen = session.render(session.state("forest", document={**SMALL, "quality": quality}), 24, 16)
        assert seen.samples == samples
        assert seen.linear.shape == (16, 24, 4)
        assert seen.rgb8.shape == (16, 24, 3)
        assert seen.meta["state"]["quality"]["kind"] == quality["kind"]


def test_a_picture_is_encoded_in_every_format(session: Session) -> None:
    seen = session.render(session.state("forest", document=SMALL), 24, 16)
    for name, head in (("png", b"\x89PNG"), ("jpeg", b"\xff\xd8"), ("exr", b"\x76\x2f\x31\x01"), ("npy", b"\x93NUMPY")):
        assert seen.encode(name).startswith(head)


def test_a_size_beyond_the_machine_is_refused_and_the_next_picture_comes(session: Session) -> None:
    state = session.state("forest", document=SMALL)
    with pytest.raises(LimitError):
        session.render(state, 10**6, 16)
    assert session.render(state, 8, 8).samples == 2


def test_a_picture_can_be_left_unfinished(session: Session) -> None:
    state = session.state("forest", document={**SMALL, "quality": {"kind": "samples", "n": 50}})
    session.render(session.state("forest", document=SMALL), 8, 8)

    def stop(progress: Any) -> None:
        raise Cancelled("enough")

    before = session.gl.live_objects()
    with pytest.raises(Cancelled):
        session.render(state, 8, 8, stop)
    assert session.gl.live_objects() == before


def test_a_missing_bake_is_made_by_a_worker_with_progress(session: Session, cache: Cache) -> None:
    state = session.state("forest", document={**SMALL, "cover": {"seed": 99}})
    plain = session.state("forest", document=SMALL)
    told: list[Any] = []
    session.prepare(state, told.append).future.result(60)
    assert session.prepared(state)
    assert {progress.name for progress in told} == {"terrain"}
    assert [progress.fraction for progress in told] == sorted(progress.fraction for progress in told)
    # the worker's mailbox holds its last word only, at most one in a while: all are heard in this process alone
    bake, said = ground_bake(state), []  # type: ignore[arg-type]
    bake.function(bake.arguments, {}, lambda fraction, words: said.append(words))
    assert said == ["reading the terrain", "laying out the forest"]
    assert told
    assert {progress.words for progress in told} <= {"starting", *said}
    other = session.render(state, 16, 16).linear
    assert (other != session.render(plain, 16, 16).linear).any(), "its own land"


def test_a_bake_that_fails_says_why_and_the_session_goes_on(session: Session) -> None:
    lost = session.state("forest", document={**SMALL, "terrain": {"kind": "asset", "asset": "asset:" + "0" * 64}})
    with pytest.raises(UmbrageError):
        session.prepare(lost).future.result(60)
    assert not session.prepared(lost)
    assert session.render(session.state("forest", document=SMALL), 8, 8).samples == 2


def test_what_was_pushed_out_of_memory_comes_back_from_the_cache(
    session: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    state = session.state("forest", document=SMALL)
    first = session.render(state, 16, 16).linear
    session._loaded.clear()
    assert not session.prepared(state)
    np.testing.assert_array_equal(session.render(state, 16, 16).linear, first)


def test_a_file_is_kept_under_its_content(session: Session, tmp_path: Path) -> None:
    path = tmp_path / "hill.npz"
    np.savez(path, elevation=np.add.outer(np.arange(40.0), np.arange(50.0)), cell_size=np.array([30.0, 30.0]))
    kept = session.add_asset(path, "hill.npz")
    assert kept["kind"] == "terrain"
    assert kept["asset"] == session.add_asset(path, "other.npz")["asset"]
    session.state("forest", document={"terrain": {"kind": "asset", "asset": kept["asset"]}})


def test_closing_leaves_no_object_and_refuses_more(cache: Cache, tmp_path: Path) -> None:
    opened = Session(cache, assets=AssetStore(tmp_path))
    state = opened.state("forest", document=SMALL)
    opened.render(state, 16, 16)
    opened.view().frame(state, 16, 16).result(60)
    assert opened.gl.live_objects() > 0
    opened.close()
    assert opened.gl.live_objects() == 0
    with pytest.raises(UmbrageError):
        opened.render(state, 16, 16)
