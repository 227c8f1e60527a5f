"""The quantity `shell`: the tetrahedra over a surface, and where they are in conflict."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from renderer.core.errors import InputError
from renderer.core.params import Model, param
from renderer.core.quantity import InputFile, Progress, Quantity, Values
from renderer.shells.base_mesh import BaseMesh
from renderer.shells.extrusion import Extrusion, extrude
from renderer.shells.shell import build_shell
from renderer.shells.shell_bake import GEOMETRY, shell_arrays, shell_facts, shell_words
from renderer.shells.surface_mapping import Mapping as Coordinates
from renderer.shells.surface_mapping import surface_of_mesh
from renderer.shells.surfaces import Sphere, Surface
from renderer.world.mesh import MeshReading, load_mesh

BRIEF = ("positions", "tets", "volumes")
"""Of the geometry, what is given where not all of it is asked for."""


class ShellArguments(Model):
    """A surface and the shell over it."""

    surface: Surface = param(
        Sphere(), label="Surface", help="As the scene shells has it; unread where a mesh is given.", cost="host"
    )
    extrusion: Extrusion = param(
        Extrusion(), label="Shell", help="As the scene shells has it.", cost="host"
    )
    reading: MeshReading = param(MeshReading(), label="Reading", help="What the file leaves unsaid.", cost="host")
    mapping: Coordinates = param(
        "file", label="Texture coordinates", help="Of the mesh: the file's own, or by a simple body.", cost="host"
    )
    size: float = param(
        0.0, label="Size", help="Of the mesh's longest side; 0 leaves it.", unit="m", cost="host", ge=0, le=1000
    )
    cells: bool = param(
        False, label="Cells", help="Whether planes, maps and all else of them are given too.", cost="host"
    )


def _base(given: ShellArguments, files: Mapping[str, Path]) -> BaseMesh:
    if "mesh" not in files:
        return given.surface.mesh()
    try:
        mesh = load_mesh(files["mesh"], reading=given.reading)
        return surface_of_mesh(mesh, given.mapping, given.size, np.ones(2))
    except InputError as failure:
        inner = failure.field in MeshReading.model_fields
        raise failure.at(f"reading.{failure.field}" if inner else "mesh", ("file", "asset")) from None


def _shell(given: ShellArguments, files: Mapping[str, Path], progress: Progress) -> Values:
    progress(0.1, "reading the surface")
    base = _base(given, files)
    progress(0.3, "extruding the surface")
    extruded = extrude(base, given.extrusion)
    arrays = shell_arrays(build_shell(base, extruded.offset), extruded)
    facts = shell_facts(arrays)
    left_out = {"counts", "flat_uv", "signs"} | (set() if given.cells else set(GEOMETRY) - set(BRIEF))
    plain = tuple(f"{name.replace('_', ' ')}: {value:,.6g}" for name, value in facts.items())
    return Values(
        {name: array for name, array in arrays.items() if name not in left_out},
        (*base.notes, *plain, *shell_words(facts)),
    )


SHELL = Quantity(
    title="Shell over a surface",
    help="The tetrahedra between a surface and its displaced copy, and the prisms in conflict before and after the "
    "shell is made thinner there.",
    arguments=ShellArguments,
    function=_shell,
    units={
        "positions": "m; [vertex of the surface, then of its copy, xyz]",
        "tets": "vertices; [tetrahedron, 4], three for each triangle",
        "volumes": "m3; [tetrahedron], negative inside out",
        "texture, to_texture, planes, neighbour": "with cells: u, v, w of the corners; affine maps from metres; planes "
        "opposite each corner, outwards; tetrahedron across, -1 above, -2 below, -3 beside",
        "share, wanted, turned": "of its wanted length that a vertex keeps; that length, m; whose direction was turned",
        "inverted, overlaps": "triangles whose prism is inside out; pairs of prisms that overlap",
        "inverted_before, overlaps_before, own_overlaps": "the same before; those that no thickness removes",
    },
    technique="prisms cut by the numbers of their vertices; conflicts by signed volumes and separating axes; offsets "
    "shortened by a seventh at a time until none is left",
    source="Dufort 2005, section 3.1, with erratum 002-7; after Peng, Kristjansson and Zorin 2004",
    error={
        "volumes": "1e-9 of a prism's volume",
        "share": "at most a seventh less than what would do",
        "overlaps": "none deeper than 1e-9 of the surface's extent is missed",
    },
    files=(InputFile("mesh", "a mesh in any format that a scene takes"),),
)
"""The quantity `shell`."""
