"""The shell as lines: its cells, its conflicts, and the triangles that hide them or take paint."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from renderer.core.technique import Arrays, Outline
from renderer.shells.animation import motion_of
from renderer.shells.animation_scene import moment
from renderer.shells.shell_bake import conflicting, shell_facts, shell_words
from renderer.shells.shell_lines import UPRIGHT, shell_lines

if TYPE_CHECKING:
    from renderer.shells.state import ShellsState

MOST_LINES = 400_000
"""Of a finer shell those in conflict and those that are shorter are given alone."""

CONFLICT, SHORTER, THERE_BEFORE = 4, 8, 16
"""Marks beside an edge's kind: a prism in conflict has it; its offset is shorter than was wanted; a prism that was in
conflict before has it."""


def outline(state: ShellsState, arrays: Mapping[str, Arrays]) -> Outline:
    """The edges of the shell's cells as it is at the document's time.

    Args:
        arrays: of the bakes `surface` and `shell`.

    Returns:
        `positions` (2V, 3) float32 [m], vertices of the surface, then their copies; `rest` (V, 3) float32 [m], the
        surface's where nothing has moved, on which paint has its places; `faces` (F, 3) uint32 of the surface;
        `ends` (E, 2) uint32 and `marks` (E,) uint8, the edges and their kind (0 of the surface, 1 of the top, 2 along
        an offset, 3 across a side) plus `CONFLICT`, `SHORTER` and `THERE_BEFORE`.
    """
    baked = arrays["shell"]
    now = moment(arrays["surface"], baked, state.extrusion, motion_of(state.motion, state.course), state.time).shell
    positions, tets = now["positions"], baked["tets"]
    count = len(positions) // 2
    ends, kind, bad = shell_lines(tets, count, conflicting(baked))
    before = np.unique(np.concatenate([baked["inverted_before"], baked["overlaps_before"].ravel()]))
    _, _, was_bad = shell_lines(tets, count, before)
    shorter = (kind == UPRIGHT) & (baked["share"] < 1)[np.minimum(ends[:, 0], count - 1)]
    marks = (kind + CONFLICT * bad + SHORTER * shorter + THERE_BEFORE * was_bad).astype(np.uint8)
    facts = shell_facts(baked)
    words = list(shell_words(facts))
    if len(ends) > MOST_LINES:
        words.append(f"{len(ends):,} lines are too many to show: those in conflict alone are given")
        kept = np.flatnonzero(marks > UPRIGHT + 1)[:MOST_LINES]
        ends, marks = ends[kept], marks[kept]
    return Outline(
        {
            "positions": positions.astype(np.float32),
            "rest": baked["positions"][:count].astype(np.float32),
            "faces": tets[0::3, :3].astype(np.uint32),
            "ends": ends.astype(np.uint32),
            "marks": marks,
        },
        facts,
        tuple(words),
    )
