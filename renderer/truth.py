"""Reference pictures of a state: its world as plain arrays, handed to the reference of its phenomenon.

A reference is a bake like any other: it runs in a worker process, with progress and cancellation, and its result is
kept under a key of its content, in which the techniques, the quality and the view of the state have no part.
"""

from __future__ import annotations

import functools
import hashlib
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from renderer import reference
from renderer.core.params import validate
from renderer.core.registry import phenomenon
from renderer.core.technique import Arrays, Bake
from renderer.truth_scenes import OPTIONS, RENDER
from renderer.world.camera import rays
from renderer.world.sampling import offsets
from renderer.world.state import SceneState

POSITIONS = 16
"""Sub-pixel positions of a reference, and of the converged picture that is compared with it."""

SECONDS: Mapping[str, tuple[float, float]] = {
    "forest": (0.0, 160e-6),
    "clouds": (60.0, 0.0),
    "shells": (5.0, 90e-6),
    "directional": (2.0, 12e-6),
}
"""What a picture takes on two cores, and each of its rays, to announce the cost: clouds have the same number of paths
in every picture."""

NOT_THE_WORLD: Mapping[str, tuple[str, ...]] = {
    "forest": ("version", "quality", "view", "time"),
    "clouds": ("version", "quality", "view"),
    "shells": ("version", "quality", "view"),
    "directional": ("version", "quality", "view", "time", "cloud", "visibility", "hemispheres"),
}
"""Fields of a state, beside its slots, that change no reference: time is the world's where clouds drift."""

THE_WORLD: Mapping[str, frozenset[str]] = {"directional": frozenset({"light"})}
"""Slots whose technique is a part of the world: lights and materials that a reference takes as they are."""


Judge = Literal["combination", "share", "shadow", "matter"]
"""What a picture is judged for: `combination` against the full physical reference, `share` against the
same with the sky's light by the pattern's own share of it, `shadow` against exact shadows under the picture's own light
and, where that is the share, its own sky, `matter` likewise against the reference without any shadow, so that what
stands where, and how it is filtered, answers alone."""

Progress = Callable[[float, str], None]


@dataclass(frozen=True)
class Truth:
    """A reference picture.

    Attributes:
        linear: (H, W, 4) float64 premultiplied radiance, W m-2 sr-1, without a background, row 0 at the top.
        once: the same from one position a pixel, its centre; of the clouds with the noise of its own paths, so that
            what it errs by is no less than the position's own error.
        backdrop: (H, W, 3) mean radiance of the background behind each pixel.
        standard_error: root mean square over the pixels, relative to the mean radiance.
        seconds: what it took when it was computed.
    """

    linear: np.ndarray
    once: np.ndarray
    backdrop: np.ndarray
    standard_error: float
    seconds: float


def truth_bake(
    state: SceneState,
    width: int,
    height: int,
    judge: Judge = "combination",
    cast: Sequence[str] | None = None,
    positions: int = POSITIONS,
) -> Bake:
    """The computation of a state's reference.

    Args:
        state: any state of a scene that has a reference.
        width, height: pixels.
        judge: what it is for.
        cast: kinds of shadow that fall, by the reference's own names; all that the judge has where none are given.
        positions: within a pixel.
    """
    found = phenomenon(state.scene)
    slots = {slot.name for slot in found.slots} - THE_WORLD.get(state.scene, frozenset())
    document = state.model_dump(mode="json", exclude={*NOT_THE_WORLD[state.scene], *slots})
    options = OPTIONS[state.scene](state, judge, cast)
    needed = [bake for bake in found.bakes(state) if bake.name in found.world_needs]
    inputs = tuple(needed if found.world_bakes is None else found.world_bakes(state))
    arguments = {
        "state": document,
        "size": [width, height],
        "positions": positions,
        "options": options,
        "code": code_of_reference(state.scene),
    }
    once, each = SECONDS[state.scene]
    return Bake("reference", bake_truth, arguments, inputs, seconds=once + width * height * positions * each)


@functools.cache
def code_of_reference(scene: str) -> str:
    """Hash of a scene's reference and of all it imports from its folder: another scene's changes leave it alone."""
    folder = Path(reference.__path__[0])
    digest, waiting, read = hashlib.sha256(), [scene], set()
    while waiting:
        name = waiting.pop()
        path = folder / f"{name}.py"
        if name in read or not path.is_file():
            continue
        read.add(name)
        waiting += sorted(re.findall(r"renderer\.reference\.(\w+)", path.read_text()))
    for name in sorted(read):
        digest.update(name.encode() + (folder / f"{name}.py").read_bytes())
    return digest.hexdigest()


@functools.cache
def code_of(*folders: Path) -> str:
    """Hash of every source text under some folders: a method that was mended cannot keep what it gave before."""
    digest = hashlib.sha256()
    for folder in folders:
        for path in sorted(folder.rglob("*")):
            if path.suffix in {".py", ".glsl", ".vert", ".frag"}:
                digest.update(path.relative_to(folder).as_posix().encode() + path.read_bytes())
    return digest.hexdigest()


def bake_truth(arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Progress) -> Arrays:
    """Compute a reference.

    Args:
        arguments: `state` (its techniques do not matter), `size`, `positions`, `options` of the reference.
        inputs: the bakes that the world needs.

    Returns:
        `linear`, `once` (H, W, 4), `backdrop` (H, W, 3), `standard_error` (), `seconds` (), as in `Truth`; of the
        clouds `regions` (H, W, 3), too, how much of a pixel meets space, cloud and ground first.
    """
    found = phenomenon(arguments["state"]["scene"])
    state: Any = validate(found.state, arguments["state"])
    world = found.world(state, inputs)
    background = world.pop("background")
    size = arguments["size"]

    def looking(place: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
        return rays(state.camera, size[0], size[1], place)

    positions = offsets(arguments["positions"])
    made = RENDER[state.scene](world, looking, positions, arguments["options"], progress)
    backdrop = np.zeros((size[1], size[0], 3))
    for place in positions:
        directions = looking((float(place[0]), float(place[1])))[1]
        backdrop += background(directions.reshape(-1, 3)).reshape(directions.shape) / len(positions)
    return {**made, "backdrop": backdrop.astype(np.float32)}


def truth_of(arrays: Arrays) -> Truth:
    """What `bake_truth` gave, by name."""
    return Truth(
        arrays["linear"], arrays["once"], arrays["backdrop"], float(arrays["standard_error"]), float(arrays["seconds"])
    )
