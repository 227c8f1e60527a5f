"""What each face of the box sees: per texel and direction, the number of a point (Porquet 2005).

A bake a face, so that one that was stopped goes on where it was; the last one joins them and finds which points any
texel sees. Porquet drops the others, more than 40 % on average, and so does `used`.
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

RAYS_A_SECOND = 3e6
"""About how many are cast and packed."""


class Visibility(Model):
    """The textures on the box's faces."""

    texels: Literal[16, 32, 64, 128, 256, 512] = param(
        128, label="Texels", help="Along each side of a face.", unit="count", cost="bake", source="Porquet 2005"
    )
    directions: Literal[33, 129, 513, 2049] = param(
        513, label="Directions", help="From which each texel looks.", unit="count", cost="bake", source="Porquet 2005"
    )


def bake_face(
    arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]
) -> Arrays:
    """What one face sees.

    Args:
        arguments: `face`, `texels`, `directions`.
        inputs: `subject`, `cloud`.

    Returns:
        `data` (B,) uint8 the packed layers, `ends` (directions,) int64 where each ends, `seen` (N,) bool the points.
    """
    face, texels = int(arguments["face"]), int(arguments["texels"])
    caster = Caster(inputs["subject"], inputs["cloud"])
    origins = face_middles(caster.box, face, texels)
    directions = hemisphere_of(int(arguments["directions"])).directions() @ face_frame(face)
    seen = np.zeros(len(inputs["cloud"]["position"]), bool)
    layers = []
    for number, direction in enumerate(directions):
        if number % 8 == 0:
            progress(number / len(directions), f"looking from face {face + 1} of {FACES}")
        points = caster.points(origins, -direction)
        seen[points[points != NONE]] = True
        layers.append(packed(points))
    return {
        "data": np.frombuffer(b"".join(layers), np.uint8),
        "ends": np.cumsum([len(layer) for layer in layers]),
        "seen": seen,
    }


def bake_visibility(
    arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]
) -> Arrays:
    """What all faces see.

    Args:
        arguments: `texels`, `directions`.
        inputs: `subject` and `face_0` to `face_5`.

    Returns:
        `used` (M,) int32 the points that any texel sees, `number` (N,) uint32 the place of each point among them;
        `data_0` to `data_5` (B,) uint8 the packed layers, `ends` (6, directions) int64 where each ends, to be read by
        `layer`; `texels` () and `directions` () int32; `box` (2, 3) [m].
    """
    progress(0.5, "joining what the faces see")
    faces = [inputs[f"face_{face}"] for face in range(FACES)]
    used = np.flatnonzero(np.any([face["seen"] for face in faces], axis=0))
    number = np.full(len(faces[0]["seen"]), NONE, np.uint32)
    number[used] = np.arange(len(used), dtype=np.uint32)
    return {
        "used": used.astype(np.int32),
        "number": number,
        "ends": np.stack([face["ends"] for face in faces]),
        "texels": np.asarray(arguments["texels"], np.int32),
        "directions": np.asarray(arguments["directions"], np.int32),
        "box": np.asarray(inputs["subject"]["box"]),
        **{f"data_{number}": face["data"] for number, face in enumerate(faces)},
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
    seconds = visibility.texels**2 * visibility.directions / RAYS_A_SECOND
    faces = tuple(
        Bake(f"face_{face}", bake_face, {**arguments, "face": face}, (subject, cloud), seconds=0.2 + seconds)
        for face in range(FACES)
    )
    return Bake("visibility", bake_visibility, arguments, (subject, *faces), seconds=0.5 + seconds / 10)
