"""What the orders' charts are drawn from: the right shells, and counts that follow from them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from renderer.core.baking import bake_key, bake_now
from renderer.core.cache import Cache
from renderer.core.params import validate
from renderer.core.technique import BakedArrays
from renderer.gl.context import GL
from renderer.gl.targets import Target
from renderer.gl.thread import GLThread
from renderer.shells.bakes import bakes
from renderer.shells.order_bench import Drawer, drift_errors, hollow_sphere, peel_times, sheets, sort_times
from renderer.shells.renderer import ShellsRenderer
from renderer.shells.state import ShellsState
from tests.shells.conftest import PLAIN
from tests.shells.order.test_walk import GLOBE
from tests.shells.order.worlds import ordered, patches


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


def test_an_order_of_a_while_ago_is_worse_the_farther_the_camera_is(thread: GLThread) -> None:
    """The camera turns round a sphere of patches; a window of one cell keeps SXMPVO's order as it was found."""
    rows = thread.call(_drifted, baked_for({**GLOBE, "order": ordered("k_buffer")["order"]}))
    late = [row["out_of_order"] for row in rows]
    assert late[0] <= 1
    assert late[0] < late[1] < late[2]
    assert rows[0]["wrong"] < 0.002
    assert rows[0]["wrong"] < rows[2]["wrong"] < 0.2


def _drifted(gl: GL, baked: Mapping[str, BakedArrays]) -> list[dict[str, float]]:
    renderer, target = ShellsRenderer(gl), Target(gl, 48, 48)

    def drawn(angle: float, order: dict[str, Any]) -> tuple[np.ndarray, int]:
        camera = {**GLOBE["camera"], "azimuth": GLOBE["camera"]["azimuth"] + angle}
        state = validate(ShellsState, {**PLAIN, **GLOBE, "camera": camera, "order": order})
        prepared = renderer.prepare(state, baked, (48, 48), (0.5, 0.5), 0)
        target.use()
        renderer.draw(prepared)
        return target.read(), renderer.rasters.said.get("out_of_order", 0)

    kept = {"kind": "k_buffer", "k": 1, "presort": "sxmpvo", "drift": 180.0}
    try:
        return drift_errors(lambda at: drawn(at, kept), lambda at: drawn(at, {"kind": "walk"})[0], (0.0, 5.0, 20.0))
    finally:
        renderer.release()
        target.release()


def baked_for(patch: dict[str, Any]) -> dict[str, BakedArrays]:
    """What a document needs, its texture patches of many colours."""
    state, cache = validate(ShellsState, {**PLAIN, **patch}), Cache()
    arrays = {bake.name: BakedArrays(bake_key(bake), bake_now(bake, cache)) for bake in bakes(state)}
    block = patches()
    texture = {
        "colour": block,
        "normal": np.zeros_like(block),
        "material": np.ones(block.shape[:3], np.uint8),
        "size": np.ones(3),
        "reference_length": np.array(0.1),
    }
    return {**arrays, "texture": BakedArrays("patches", texture)}


def _peeled(gl: GL, state: ShellsState, baked: Mapping[str, BakedArrays]) -> list[dict[str, float]]:
    drawer = Drawer(gl, state, baked, 16)
    try:
        return peel_times(drawer, 24, (1, 2, 4), turns=1)
    finally:
        drawer.release()
