"""What is shown: the union of subjects of the state document, and the mesh of each."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

import numpy as np
from pydantic import Field, TypeAdapter

from renderer.core.errors import InputError
from renderer.core.params import bake_arguments
from renderer.core.technique import Arrays, Bake
from renderer.directional.subject.basket import Basket
from renderer.directional.subject.dragon import Dragon
from renderer.directional.subject.knot import Knot
from renderer.directional.subject.mesh import OwnMesh
from renderer.directional.subject.points import OwnPoints
from renderer.directional.subject.relief import Relief
from renderer.directional.subject.rock import Rock
from renderer.directional.subject.solid import compact
from renderer.directional.subject.teapot import Teapot
from renderer.directional.subject.tree import Tree
from renderer.world.mesh import MAX_COORDINATE

AnySubject = Dragon | Teapot | Basket | Knot | Rock | Tree | Relief | OwnMesh | OwnPoints

Subject = Annotated[AnySubject, Field(discriminator="kind")]

_SUBJECTS: TypeAdapter[AnySubject] = TypeAdapter(Subject)

MARGIN = 0.005
"""By which each side of the box stands off the subject, as a share of its diagonal."""


def bake_subject(
    arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]
) -> Arrays:
    """The mesh of a subject: what rays meet, and what the reference draws.

    Args:
        arguments: the document's `subject`, as `bake_arguments` gives it.

    Returns:
        `vertices` (V, 3) float64 [m], `faces` (F, 3) int32, `normals` (F, 3, 3) float64 unit shading normals of the
        corners, `colour` (F, 3) float64 linear reflectance, `two_sided` () bool, `box` (2, 3) [m], `lift` () [m] how
        far off the surface rays to the light begin, `notes` (N,) text, and, where faces stand for points of the user's,
        `source` (F,) int32.

    Raises:
        InputError: a file of the user's cannot be had, or used.
    """
    progress(0.1, "making the subject")
    subject = _SUBJECTS.validate_python(arguments)
    made_of = subject.solid(progress) if isinstance(subject, OwnPoints) else subject.solid()
    solid = compact(made_of.stood(subject.size))
    vertices = np.ascontiguousarray(solid.vertices, np.float64)
    if np.abs(vertices).max() > MAX_COORDINATE:
        raise InputError("subject.size", f"of 0 leaves points up to {np.abs(vertices).max():g} m from the origin",
                         f"at most {MAX_COORDINATE:g} m, or a size above 0")
    made: dict[str, np.ndarray] = {
        "vertices": vertices,
        "faces": np.ascontiguousarray(solid.faces, np.int32),
        "normals": np.asarray(solid.shaded(), np.float64),
        "colour": np.clip(np.asarray(solid.colour, np.float64), 0.0, 1.0),
        "two_sided": np.asarray(solid.two_sided),
        "box": box_of(vertices, solid.faces),
        "lift": np.asarray(solid.lift),
        "notes": np.array(solid.notes, dtype=np.str_),
    }
    return made if solid.source is None else {**made, "source": solid.source.astype(np.int32)}


def box_of(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Lowest and highest corner (2, 3) [m] of the box whose faces see the subject."""
    used = vertices[np.unique(faces)]
    low, high = used.min(axis=0), used.max(axis=0)
    margin = MARGIN * float(np.linalg.norm(high - low))
    return np.stack([low - margin, high + margin])


def subject_bake(subject: AnySubject) -> Bake:
    """The subject's mesh."""
    return Bake("subject", bake_subject, bake_arguments(subject), version=3, seconds=3)
