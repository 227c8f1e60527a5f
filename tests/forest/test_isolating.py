"""Each isolating view is ruled by its own kind of shadow, in the reference; and what techniques hold is counted."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from renderer import truth
from renderer.core.errors import InputError
from renderer.core.params import validate
from renderer.core.registry import techniques
from renderer.forest.isolating import ISOLATIONS, VIEWS, contenders, held_bytes
from renderer.forest.state import ForestState
from renderer.kind_study import KindStudy, Plan
from renderer.session import Session

SIDE = 16
KINDS = ISOLATIONS[:4]


@pytest.fixture(scope="module")
def study() -> Iterator[KindStudy]:
    with Session() as session:
        yield KindStudy(session, Plan("forest", SIDE, SIDE).checked())


@pytest.fixture(autouse=True)
def one_ray_a_pixel(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(truth, "POSITIONS", 1)


def rules(study: KindStudy, isolation: Any) -> bool:
    """Whether a kind changes more than any other where it changes much, and that is a part worth looking at."""
    try:
        shares = study.shares(isolation)
    except InputError:
        return False
    return max(shares, key=lambda name: shares[name]) == isolation.name and study.mask(isolation, SIDE).mean() > 0.15


@pytest.mark.parametrize("number", range(4))
def test_a_kind_rules_its_own_view_and_not_the_next(study: KindStudy, number: int) -> None:
    assert rules(study, KINDS[number])
    assert not rules(study, replace(KINDS[number], preset=KINDS[(number + 1) % 4].preset))


def test_every_view_is_a_preset_that_says_where_to_look(study: KindStudy) -> None:
    presets = study.session.describe("forest")["presets"]
    for isolation in KINDS:
        assert presets[isolation.preset]["help"].startswith("Look ")
        assert presets[isolation.preset]["group"]
    assert set(VIEWS) == {isolation.preset for isolation in KINDS}


def test_every_shadow_technique_is_a_contender() -> None:
    found = contenders()
    assert len({one.label for one in found}) == len(found)
    alone = [one.patch["shadow"] for one in found if not one.combination and "height_shading" not in one.patch]
    assert {shadow["kind"] for shadow in alone} == set(techniques("forest", "shadow"))
    assert {shadow["sectors"] for shadow in alone if shadow["kind"] == "horizon_map"} == {4, 8, 16, 32}
    for one in found:
        validate(ForestState, {"scene": "forest", **one.patch})


@pytest.mark.parametrize(
    ("shadow", "texels"),
    [
        ({"kind": "none"}, 0),
        ({"kind": "depth_shadow_map", "resolution": 512}, 512**2),
        ({"kind": "depth_shadow_map", "resolution": 2048}, 2048**2),
        ({"kind": "cascaded_shadow_map", "resolution": 512, "cascades": 3}, 3 * 512**2),
    ],
)
def test_what_the_sun_draws_is_counted(shadow: dict[str, Any], texels: int) -> None:
    state = validate(ForestState, {"scene": "forest", "light": {"kind": "gouraud"}, "shadow": shadow})
    land = {"elevation": np.zeros((512, 512)), "growth": np.ones((512, 512))}
    assert held_bytes(state, {"terrain": land}, (64, 64)) == 4 * texels


def test_textures_are_counted_as_they_are_sent() -> None:
    state = validate(
        ForestState, {"scene": "forest", "light": {"kind": "gouraud"}, "shadow": {"kind": "horizon_map", "sectors": 4}}
    )
    terrain = {"sectors": np.zeros((4, 512, 512))}
    canopy = {"sectors": np.zeros((1, 4, 64, 64))}
    baked = {"terrain_horizon": terrain, "canopy_horizon": canopy}
    # one direction of each stays, as floats
    assert held_bytes(state, baked, (64, 64)) >= 4 * (512 * 512 + 64 * 64)
