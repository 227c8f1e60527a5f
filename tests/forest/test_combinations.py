"""Named combinations of techniques: each is a whole choice, and leaves view and world alone."""

from __future__ import annotations

import pytest

from renderer.core.errors import InputError
from renderer.core.params import merge, validate
from renderer.forest.combinations import COMBINATIONS
from renderer.forest.phenomenon import PHENOMENON
from renderer.forest.state import SLOTS, ForestState


@pytest.mark.parametrize("name", COMBINATIONS)
def test_a_combination_sets_slots_alone(name: str) -> None:
    patch = COMBINATIONS[name].patch
    assert set(patch) <= set(SLOTS)
    assert {"shadow", "height_shading", "light"} <= set(patch), "else it would depend on what was chosen before"
    before = ForestState(scene="forest")
    after = validate(PHENOMENON.state, merge(before.model_dump(mode="json"), patch))
    for field in ForestState.model_fields:
        if field not in patch:
            assert getattr(after, field) == getattr(before, field)
    for slot, chosen in patch.items():
        assert getattr(after, slot).kind == chosen["kind"]


@pytest.mark.parametrize("name", COMBINATIONS)
def test_it_means_the_same_whatever_was_chosen_before(name: str) -> None:
    patch = COMBINATIONS[name].patch
    document = ForestState(scene="forest").model_dump(mode="json")
    found = set()
    for before in COMBINATIONS.values():
        state = validate(PHENOMENON.state, merge(merge(document, before.patch), patch))
        found.add(tuple(str(getattr(state, slot)) for slot in ("height_shading", "light")))
    assert len(found) == 1


def test_an_unknown_one_is_refused_by_name() -> None:
    from renderer.session import Session

    with Session() as session, pytest.raises(InputError) as refused:
        session.state("forest", combination="best")
    assert refused.value.field == "combination"
    assert "thesis" in str(refused.value.allowed)
