"""The state every scene shares: defaults, version, qualities."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from renderer.core.errors import InputError, InvalidDocument
from renderer.core.params import validate
from renderer.world.image import display, srgb_decode
from renderer.world.state import (
    CONVERGED_SAMPLES,
    DARKEST,
    NOON,
    VERSION,
    Converged,
    Draft,
    Samples,
    SceneState,
    View,
    exposure_ev,
    migrate,
    samples_of,
)


def test_a_document_survives_json() -> None:
    """What is written is read back as the same state, and the defaults are a valid document."""
    state = SceneState()
    assert validate(SceneState, json.loads(json.dumps(state.model_dump(mode="json")))) == state
    assert json.dumps(SceneState.model_json_schema())


def test_qualities_say_their_samples() -> None:
    """Draft is one sample; converged is a fixed number, so that two doors agree."""
    assert [samples_of(q) for q in (Draft(), Samples(n=7), Converged())] == [1, 7, CONVERGED_SAMPLES]


def test_a_document_without_version_is_of_this_one() -> None:
    """What is written by hand means what the documentation says today."""
    assert migrate({"view": {"exposure": 3}}) == {"view": {"exposure": 3}, "version": VERSION}


@pytest.mark.parametrize(("view", "old"), [
    ({"exposure": -7.4, "tone_curve": "linear"}, -7.4), ({}, -6.5), (None, -6.5),
])
def test_a_link_of_version_one_keeps_its_brightness(view: dict[str, Any] | None, old: float) -> None:
    """Its exposure was fixed, in stops over 1 W m-2 sr-1; it stays so under any light."""
    document = {"version": 1} if view is None else {"version": 1, "view": view}
    state = validate(SceneState, migrate(document))
    for light in (0.0, 30.0, 1200.0):
        assert exposure_ev(state.view, light) == pytest.approx(old, abs=1e-9)
    assert state.view.tone_curve == (view or {}).get("tone_curve", "filmic")


@pytest.mark.parametrize("wrong", [{"exposure": "x"}, {"exposure": True}, {"exposure": 10**400}, 3])
def test_a_wrong_view_of_version_one_is_refused_by_its_name(wrong: Any) -> None:
    """It is passed on as it is, for validation to answer."""
    with pytest.raises(InvalidDocument) as refused:
        validate(SceneState, migrate({"version": 1, "view": wrong}))
    assert refused.value.errors[0].field.startswith("view")


@pytest.mark.parametrize("light", [DARKEST, 40.0, 1100.0])
def test_a_grey_card_is_shown_as_it_is(light: float) -> None:
    """Matt 18 % grey, by the linear curve, without compensation; one stop doubles it."""
    # a square of the dither's: its mean is what the eye sees
    card = np.full((4, 4, 3), 0.18 * light / np.pi)
    shown = [display(card, exposure_ev(View(exposure=stops), light), "linear").mean() for stops in (0.0, 1.0)]
    assert srgb_decode(np.array(shown) / 255) == pytest.approx([0.18, 0.36], rel=0.01)


def test_night_falls_and_a_fixed_exposure_stays() -> None:
    """Below civil twilight the exposure follows the light no further."""
    assert exposure_ev(View(), 1e-6) == exposure_ev(View(), DARKEST) > exposure_ev(View(), 2 * DARKEST)
    fixed = View(auto_exposure=False)
    assert exposure_ev(fixed, 1.0) == exposure_ev(fixed, 500.0) == exposure_ev(View(), NOON)


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
        ({"view": {"auto_exposure": 1}}, "view.auto_exposure"),
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
