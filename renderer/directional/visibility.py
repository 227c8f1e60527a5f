"""What each face of the box sees: per texel and direction, the number of a point (Porquet 2005).

A long bake is one of each face, so that when it was stopped it goes on where it was; the last one joins them and finds
which points any texel sees. Porquet drops the others, more than 40 % on average, and so does `used`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

import numpy as np

from renderer.core.params import Model, bake_arguments, param
from renderer.core.technique import Arrays, Bake
from renderer.directional.casting import NONE, Caster, face_frame, face_middles
from renderer.directional.hemisphere import hemisphere_of
from renderer.directional.index_code import packed, unpacked

FACES = 6

RAYS_A_SECOND = 4e6
"""About how many are cast and packed."""

WORTH_KEEPING = 10.0
"""Expected seconds from which on what the first faces saw is kept while the others look."""

REPORTED = 8
"""Directions between two reports."""


class Visibility(Model):
    """The textures on the box's faces."""

    texels: Literal[16, 32, 64, 128, 256, 512] = param(
        128, label="Texels", help="Along each side of a face.", unit="count", cost="bake", source="Porquet 2005"
    )
    directions: Literal[33, 129, 513, 2049] = param(
        513, label="Directions", help="From which each texel looks.", unit="count", cost="bake", source="Porquet 2005"
    )


def bake_faces(
    arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]
) -> Arrays:
    """What some faces see.

    Args:
        arguments: `faces`, their numbers; `texels`, `directions`.
        inputs: `subject`, `cloud`.

    Returns:
        `data_0` ... (B,) uint8 the packed layers of each of these faces, `ends` (faces, directions) int64 where each
        layer ends, `seen` (N,) bool the points that any of their texels sees.
    """
    faces, texels = [int(face) for face in arguments["faces"]], int(arguments["texels"])
    caster = Caster(inputs["subject"], inputs["cloud"])
    seen = np.zeros(len(inputs["cloud"]["position"]), bool)
    directions = hemisphere_of(int(arguments["directions"])).directions()
    data, ends = {}, []
    for place, face in enumerate(faces):
        origins = face_middles(caster.box, face, texels)
        layers = []
        for number, direction in enumerate(directions @ face_frame(face)):
            if number % REPORTED == 0:
                share = (place + number / len(directions)) / len(faces)
                progress(share, f"looking from face {face + 1} of {FACES}")
            points = caster.points(origins, -direction)
            seen[points[points != NONE]] = True
            layers.append(packed(points))
        data[f"data_{face}"] = np.frombuffer(b"".join(layers), np.uint8)
        ends.append(np.cumsum([len(layer) for layer in layers]))
    return {**data, "ends": np.stack(ends), "seen": seen}


def bake_visibility(
    arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]
) -> Arrays:
    """What all faces see.

    Args:
        arguments: `texels`, `directions`.
        inputs: `subject` and bakes of `bake_faces` that have every face once.

    Returns:
        `used` (M,) int32 the points that any texel sees, `number` (N,) uint32 the place of each point among them;
        `data_0` to `data_5` (B,) uint8 the packed layers, `ends` (6, directions) int64 where each ends, to be read by
        `layer`; `texels` () and `directions` () int32; `box` (2, 3) [m].
    """
    progress(0.5, "joining what the faces see")
    parts = [part for name, part in sorted(inputs.items()) if name != "subject"]
    used = np.flatnonzero(np.any([part["seen"] for part in parts], axis=0))
    number = np.full(len(parts[0]["seen"]), NONE, np.uint32)
    number[used] = np.arange(len(used), dtype=np.uint32)
    return {
        "used": used.astype(np.int32),
        "number": number,
        "ends": np.concatenate([part["ends"] for part in parts]),
        "texels": np.asarray(arguments["texels"], np.int32),
        "directions": np.asarray(arguments["directions"], np.int32),
        "box": np.asarray(inputs["subject"]["box"]),
        **{name: part[name] for part in parts for name in part if name.startswith("data_")},
    }


def layer(arrays: Arrays, face: int, direction: int) -> np.ndarray:
    """What a face sees in a direction: (d, d) uint32 places in `used`, `NONE` where nothing.

    Args:
        arrays: of `bake_visibility`. face, direction: their numbers.
    """
    texels = int(arrays["texels"])
    end = arrays["ends"][face]
    begin = int(end[direction - 1]) if direction else 0
    points = unpacked(arrays[f"data_{face}"][begin:int(end[direction])], texels * texels)
    seen = points != NONE
    points[seen] = arrays["number"][points[seen]]
    return points.reshape(texels, texels)


def visibility_bake(visibility: Visibility, subject: Bake, cloud: Bake) -> Bake:
    """What the faces see of a subject's points."""
    arguments = bake_arguments(visibility)
    seconds = FACES * visibility.texels**2 * visibility.directions / RAYS_A_SECOND
    # Each part sorts the subject for its rays anew, which a short bake would feel.
    each = 1 if seconds > WORTH_KEEPING else FACES
    parts = tuple(
        Bake(f"faces_{first}", bake_faces, {**arguments, "faces": list(range(first, first + each))}, (subject, cloud),
             seconds=1 + seconds * each / FACES)
        for first in range(0, FACES, each)
    )
    return Bake("visibility", bake_visibility, arguments, (subject, *parts), seconds=0.5 + seconds / 20)
