"""The renderer against the reference, which shares no code with it: what is left once every approximation is off."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from renderer.session import Session
from renderer.study.metrics import relative_rmse
from renderer.truth import truth_bake, truth_of
from renderer.world.sampling import offset

SIDE = 32
POSITIONS = 4
PASSES = 16
BUDGET = 0.06
"""Relative RMSE of the unshadowed forest, marched without mip levels: 0.02 to 0.05 of jitter left over and of steps a
voxel long."""

BARE = {"shadow.kind": "none", "height_shading.kind": "none", "filter.kind": "none", "view.background": "none"}
UNSHADOWED = {"terrain": False, "forest_on_ground": False, "tree_on_tree": False, "within_tree": False}


@pytest.mark.parametrize(
    ("spoiled", "agrees"), [({}, True), ({"light.kind": "gouraud"}, False), ({"ground.map_seed": 1}, False)]
)
def test_the_unshadowed_forest_is_the_references(spoiled: dict[str, Any], agrees: bool) -> None:
    sets = {**BARE, "sun": {"kind": "direction", "azimuth": 120.0, "elevation": 35.0}}
    with Session() as session:
        state = session.state("forest", "forest_edge", sets)
        bake = truth_bake(state, SIDE, SIDE)
        arguments = {**bake.arguments, "positions": POSITIONS, "options": {"light": "leaf", **UNSHADOWED}}
        found = truth_of(session.compute(replace(bake, arguments=arguments)))
        drawn = session.state("forest", "forest_edge", {**sets, **spoiled})
        picture = session.draw(drawn, SIDE, SIDE, POSITIONS * PASSES, lambda n: offset(n % POSITIONS))
    error = relative_rmse(picture.linear, found.linear)
    assert (error < BUDGET) is agrees, error
