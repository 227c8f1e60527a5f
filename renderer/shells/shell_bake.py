"""The shell as a precomputation: its arrays, its conflicts, and what is to be said of them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from pydantic import TypeAdapter
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from renderer.core.technique import Arrays, Bake
from renderer.shells.extrusion import Extruded, Extrusion, extrude
from renderer.shells.shell import LOWER, SIDES, Edges, Shell, build_shell
from renderer.shells.surfaces import surface_of

GEOMETRY = ("positions", "tets", "texture", "planes", "to_texture", "neighbour", "signs", "volumes", "flat_uv")
"""Arrays of a `Shell`, kept under their names."""

_EXTRUSION = TypeAdapter(Extrusion)


def shell_bake(extrusion: Extrusion, surface: Bake) -> Bake:
    """The shell over a baked surface."""
    return Bake("shell", bake_shell, extrusion.model_dump(mode="json"), (surface,), version=2, seconds=1)


def bake_shell(arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]) -> Arrays:
    """The shell over a surface.

    Args:
        arguments: the document's `extrusion`.
        inputs: `surface`, as `bake_surface` gives it.

    Returns:
        the arrays of `Shell` by their names; `counts` (4,) int64, open, crowded and turned edges and pinched vertices;
        and where it fits:
        `share` (V,) of its wanted length that each vertex keeps, `wanted` (V,) that length [m], `turned` (V,) bool
        whose direction was turned, `inverted` (N,) and `overlaps` (M, 2) prisms in conflict, `inverted_before` and
        `overlaps_before` those before clamping, `own_overlaps` (K, 2) those that no thickness removes.

    Raises:
        InputError: `extrusion.relief.asset`.
    """
    progress(0.1, "extruding the surface")
    base = surface_of(inputs["surface"])
    extruded = extrude(base, _EXTRUSION.validate_python(arguments))
    progress(0.8, "cutting prisms into tetrahedra")
    return shell_arrays(build_shell(base, extruded.offset), extruded)


def shell_arrays(shell: Shell, extruded: Extruded) -> dict[str, np.ndarray]:
    """What `bake_shell` gives, from the shell and where it stands."""
    clamped = extruded.clamped
    return {
        **{name: getattr(shell, name) for name in GEOMETRY},
        "counts": np.array([shell.edges.open, shell.edges.crowded, shell.edges.turned, pinched_vertices(shell)]),
        "share": clamped.share,
        "wanted": extruded.length,
        "turned": extruded.turned,
        "inverted": clamped.left.inverted,
        "overlaps": clamped.left.overlaps,
        "inverted_before": clamped.wanted.inverted,
        "overlaps_before": clamped.wanted.overlaps,
        "own_overlaps": clamped.own,
    }


def pinched_vertices(shell: Shell) -> int:
    """How many vertices of the base join several fans of triangles, which share that vertex and no edge there."""
    # Each fan around a vertex is what its corners are linked to across edges.
    base = shell.tets[0::3, :3]
    prisms = np.arange(len(base))
    links = []
    for side, (cell, corner) in zip(SIDES, LOWER):
        across = shell.neighbour[cell::3, corner]
        here = prisms[across >= 0]
        there = across[across >= 0] // 3
        for own in side:
            at = (base[there] == base[here, own][:, None]).argmax(axis=1)
            links.append(np.stack([3 * here + own, 3 * there + at], axis=1))
    pairs = np.concatenate(links)
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(base.size, base.size))
    _, fan = connected_components(graph, directed=False)
    vertex = np.unique(np.stack([base.ravel(), fan], axis=1), axis=0)[:, 0]
    return int((np.bincount(vertex) > 1).sum())


def shell_of(arrays: Arrays) -> Shell:
    """The shell from what `bake_shell` gave."""
    edges = Edges(*(int(count) for count in arrays["counts"][:3]))
    return Shell(**{name: arrays[name] for name in GEOMETRY}, edges=edges)


def conflicting(arrays: Arrays) -> np.ndarray:
    """Numbers of the prisms in conflict, (N,)."""
    return np.unique(np.concatenate([arrays["inverted"], arrays["overlaps"].ravel()]))


def shell_facts(arrays: Arrays) -> dict[str, int | float]:
    """What the page says of a shell, in numbers.

    Returns:
        counts of triangles, tetrahedra, vertices; of edges that are open, crowded (three triangles or more) or turned
        (two that disagree on their front); of pinched vertices, whose triangles no edges join; of triangles with flat
        texture coordinates; of prisms inside out and pairs of prisms that overlap, before and after clamping; of
        vertices clamped and turned; the least share kept; the volume [m3]; bytes of the geometry.
    """
    share = arrays["share"]
    opened, crowded, turned, pinched = (int(count) for count in arrays["counts"])
    return {
        "triangles": len(arrays["tets"]) // 3,
        "tetrahedra": len(arrays["tets"]),
        "vertices": len(arrays["positions"]),
        "open_edges": opened,
        "crowded_edges": crowded,
        "turned_edges": turned,
        "pinched_vertices": pinched,
        "flat_uv": len(arrays["flat_uv"]),
        "inverted_before": len(arrays["inverted_before"]),
        "overlaps_before": len(arrays["overlaps_before"]),
        "inverted": len(arrays["inverted"]),
        "overlaps": len(arrays["overlaps"]),
        "own_overlaps": len(arrays["own_overlaps"]),
        "clamped_vertices": int((share < 1).sum()),
        "turned_vertices": int(arrays["turned"].sum()),
        "least_share": float(share.min()),
        "volume": float(np.abs(arrays["volumes"]).sum()),
        "bytes": sum(arrays[name].nbytes for name in GEOMETRY),
    }


def shell_words(facts: dict[str, int | float]) -> list[str]:
    """What must be told of a shell in words: nothing where all is well."""
    plain = (
        ("crowded_edges", "edge joins more than two triangles", "edges join more than two triangles"),
        ("turned_edges", "edge has triangles that disagree on their front", "edges have triangles that disagree"),
        ("pinched_vertices", "vertex joins parts that share no edge", "vertices join parts that share no edge"),
        ("flat_uv", "triangle has texture coordinates without area", "triangles have texture coordinates without area"),
        ("clamped_vertices", "vertex has a shorter offset", "vertices have shorter offsets"),
        ("inverted", "prism is inside out", "prisms are inside out"),
        ("overlaps", "pair of prisms overlaps", "pairs of prisms overlap"),
        ("own_overlaps", "overlap is the surface's own", "overlaps are the surface's own: no thickness removes them"),
    )
    said = []
    for name, one, many in plain:
        count = int(facts[name])
        if count:
            said.append(f"{count:,} {one if count == 1 else many}")
        if count and name == "clamped_vertices":
            before = int(facts["inverted_before"]), int(facts["overlaps_before"])
            said[-1] += f" against {before[0]:,} prisms inside out and {before[1]:,} overlaps"
    return said
