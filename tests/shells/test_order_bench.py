"""What the orders' charts are drawn from: the right shells, and counts that follow from them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from renderer.core.baking import bake_key, bake_now
from renderer.core.cache import Cache
from renderer.core.params import validate
from renderer.core.technique import BakedArrays
from renderer.gl.context import GL
from renderer.gl.thread import GLThread
from renderer.shells.bakes import bakes
from renderer.shells.order_bench import Drawer, hollow_sphere, peel_times, sheets, sort_times
from renderer.shells.state import ShellsState
from tests.shells.conftest import PLAIN


def test_sheets_hold_as_many_cells_however_many_there_are() -> None:
    for layers in (1, 2, 4, 8):
        shell = sheets(layers, 1536)
        assert len(shell.tets) == pytest.approx(1536, rel=0.15)
        assert (shell.volumes > 0).all()
        assert len(np.unique(shell.positions[:, 2].round(6))) == 2 * layers
        assert np.ptp(shell.positions[:, :2], axis=0) == pytest.approx([1, 1])


def test_a_hollow_sphere_is_sorted_by_relations_of_faces_and_of_pixels() -> None:
    rows = sort_times((2, 3), side=64, turns=1)
    assert [row["cells"] for row in rows] == [144, 324]
    for row, division in zip(rows, (2, 3), strict=True):
        shared = (hollow_sphere(division).neighbour >= 0).sum() / 2
        assert 0.9 * shared < row["relations"] - row["of_pixels"] <= shared
        assert row["of_pixels"] > 0
        assert row["cycles"] == 0


def test_a_layer_more_is_three_passes_more(thread: GLThread) -> None:
    """Straight from above every ray meets the three cells of a prism of each sheet."""
    state = validate(ShellsState, {**PLAIN, "order": {"kind": "depth_peeling"}, "texture": {"kind": "uniform"}})
    cache = Cache()
    baked = {bake.name: BakedArrays(bake_key(bake), bake_now(bake, cache)) for bake in bakes(state)}
    rows = thread.call(_peeled, state, baked)
    assert [row["passes"] for row in rows] == [3, 6, 12]


def _peeled(gl: GL, state: ShellsState, baked: Mapping[str, BakedArrays]) -> list[dict[str, float]]:
    drawer = Drawer(gl, state, baked, 16)
    try:
        return peel_times(drawer, 24, (1, 2, 4), turns=1)
    finally:
        drawer.release()
