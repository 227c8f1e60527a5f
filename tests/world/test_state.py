"""The state every scene shares: defaults, version, qualities."""

from __future__ import annotations

import json
from typing import Any

import pytest

from renderer.core.errors import InputError, InvalidDocument
from renderer.core.params import validate
from renderer.world.state import CONVERGED_SAMPLES, VERSION, Converged, Draft, Samples, SceneState, migrate, samples_of


def test_a_document_survives_json() -> None:
    """What is written is read back as the same state, and the defaults are a valid document."""
    state = SceneState()
    assert validate(SceneState, json.loads(json.dumps(state.model_dump(mode="json")))) == state
    assert json.dumps(SceneState.model_json_schema())


def test_qualities_say_their_samples() -> None:
    """Draft is one sample; converged is a fixed number, so that two doors agree."""
    assert [samples_of(q) for q in (Draft(), Samples(n=7), Converged())] == [1, 7, CONVERGED_SAMPLES]


def test_a_document_without_version_is_of_the_first() -> None:
    """Links from before the field was required still open."""
    assert migrate({"time": 3}) == {"time": 3, "version": VERSION}
    assert migrate({"version": 1, "time": 3}) == {"time": 3, "version": 1}


@pytest.mark.parametrize("version", [VERSION + 1, 0, "1", True, None])
def test_other_versions_are_refused(version: Any) -> None:
    """A newer document would be drawn wrongly; the answer says which versions are known."""
    with pytest.raises(InputError) as refused:
        migrate({"version": version})
    assert refused.value.field == "version"


@pytest.mark.parametrize("document", [None, [], "x", 3])
def test_only_objects_are_documents(document: Any) -> None:
    """Any other JSON value is refused in words."""
    with pytest.raises(InputError):
        migrate(document)


@pytest.mark.parametrize(
    ("document", "field"),
    [
        ({"quality": {"kind": "samples", "n": 0}}, "quality.n"),
        ({"quality": {"kind": "samples", "n": 2.5}}, "quality.n"),
        ({"quality": {"kind": "samples", "n": 5000}}, "quality.n"),
        ({"view": {"exposure": float("nan")}}, "view.exposure"),
        ({"view": {"tone_curve": "reinhard"}}, "view.tone_curve"),
        ({"view": {"background": "#fff"}}, "view.background"),
        ({"time": -1}, "time"),
        ({"colour": 1}, "colour"),
        ({"sun": {"kind": "moon"}}, "sun.kind"),
        ({"camera": 3}, "camera"),
    ],
)
def test_bad_values_are_refused_by_name(document: dict[str, Any], field: str) -> None:
    """Each error names its field as the document does, without the union's tags."""
    with pytest.raises(InvalidDocument) as refused:
        validate(SceneState, document)
    assert [error.field for error in refused.value.errors] == [field]
