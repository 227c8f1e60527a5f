"""Edges of cells, each once, by kind."""

from __future__ import annotations

import numpy as np

from renderer.shells.shell import build_shell
from renderer.shells.shell_lines import BASE_EDGE, DIAGONAL, TOP_EDGE, UPRIGHT, shell_lines
from renderer.world.mesh_normals import vertex_normals
from tests.shells.meshes import torus


def test_every_edge_comes_once_and_by_its_kind() -> None:
    """A closed mesh of V vertices and E edges has E edges below, E above, V upright and one diagonal for each side."""
    mesh = torus()
    count = len(mesh.vertices)
    shell = build_shell(mesh, 0.1 * vertex_normals(mesh.vertices, mesh.faces))
    ends, kind, bad = shell_lines(shell.tets, count, np.array([5, 9]))
    edges = 3 * len(mesh.faces) // 2
    assert [int((kind == k).sum()) for k in (BASE_EDGE, TOP_EDGE, UPRIGHT, DIAGONAL)] == [edges, edges, count, edges]
    assert len(np.unique(ends, axis=0)) == len(ends)
    assert (ends[:, 0] < ends[:, 1]).all()
    corners = {int(v) for prism in (5, 9) for v in shell.tets[3 * prism : 3 * prism + 3].ravel()}
    assert {int(v) for v in ends[bad].ravel()} == corners
    assert bad.sum() == 2 * 12
