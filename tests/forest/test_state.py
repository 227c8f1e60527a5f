"""The forest's document: its defaults, its presets, and what it refuses, by name."""

from __future__ import annotations

from typing import Any

import pytest

from renderer.core.errors import InvalidDocument
from renderer.core.params import merge, validate
from renderer.core.registry import techniques
from renderer.forest.bakes import bakes
from renderer.forest.phenomenon import PHENOMENON, PRESETS
from renderer.forest.state import DEFAULTS, SLOTS, ForestState


def document(**patch: Any) -> dict[str, Any]:
    return merge(ForestState().model_dump(mode="json"), patch)


def test_slots_defaults_and_techniques_agree() -> None:
    state = ForestState()
    assert tuple(slot.name for slot in PHENOMENON.slots) == SLOTS == tuple(DEFAULTS)
    for slot in PHENOMENON.slots:
        assert slot.default in techniques("forest", slot.name)
        assert getattr(state, slot.name).kind == slot.default


@pytest.mark.parametrize("name", list(PRESETS))
def test_presets_are_whole_documents(name: str) -> None:
    state = validate(ForestState, document(**PRESETS[name].patch))
    assert validate(ForestState, state.model_dump(mode="json")) == state


@pytest.mark.parametrize(("patch", "field"), [
    ({"shadow": {"kind": "double_horizon_map", "softness": 21}}, "shadow.softness"),
    ({"shadow": {"kind": "shadow_volume"}}, "shadow.kind"),
    ({"shadow": {"kind": "none", "softness": 3}}, "shadow.softness"),
    ({"geometry": {"kind": "slices", "count": 2.5}}, "geometry.count"),
    ({"ground": {"albedo": [0.1, 0.2, 1.2]}}, "ground.albedo.2"),
    ({"ground": {"tint_strength": float("nan")}}, "ground.tint_strength"),
    ({"terrain": {"kind": "asset", "asset": "../etc"}}, "terrain.asset"),
    ({"canopy": {"mesh": "tree.obj"}}, "canopy.mesh"),
    ({"scene": "clouds"}, "scene"),
    ({"wind": 3}, "wind"),
])
def test_what_is_wrong_is_named(patch: dict[str, Any], field: str) -> None:
    with pytest.raises(InvalidDocument) as refused:
        validate(ForestState, document(**patch))
    assert field in [error.field for error in refused.value.errors]


def test_bakes_come_once_and_after_their_inputs() -> None:
    found = bakes(ForestState())
    names = [bake.name for bake in found]
    assert len(names) == len(set(names))
    assert {"sky", "terrain", "pattern", "transmittance"} == set(names)
    for place, bake in enumerate(found):
        assert {source.name for source in bake.inputs} <= set(names[:place])


def test_only_what_a_bake_reads_changes_it() -> None:
    def keys(**patch: Any) -> dict[str, dict[str, Any]]:
        return {bake.name: bake.arguments for bake in bakes(validate(ForestState, document(**patch)))}

    plain = keys()
    for live in ({"sun": {"azimuth": 3}}, {"camera": {"distance": 50}}, {"ground": {"tint_strength": 0.1}},
                 {"shadow": {"strength": 0.5}}, {"light": {"kind": "gouraud"}}, {"view": {"exposure": 0}}):
        assert keys(**live) == plain
    assert keys(cover={"clearings": 0.5})["terrain"] != plain["terrain"]
    assert keys(canopy={"seed": 9})["pattern"] != plain["pattern"]
    assert keys(air={"haze": 20})["sky"] != plain["sky"]
    assert keys(shadow={"coefficients": 4})["transmittance"] != plain["transmittance"]
    assert set(keys(shadow={"kind": "none"})) == {"sky", "terrain", "pattern"}
