"""Codes of shadow hemispheres on clouds of points: what each misjudges in how many bytes, and what masks miss.

Masks of all points of a cloud are cast, coded and read again. A direction is misjudged where what is read lies on the
other side of a half; all directions count alike. Between directions the truth is a ray.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from renderer.core.errors import InputError
from renderer.core.params import bake_arguments
from renderer.core.technique import Arrays
from renderer.directional.cloud import bake_cloud
from renderer.directional.codes.baking import CODE_SIZES, MAKERS
from renderer.directional.codes.bits import Bits
from renderer.directional.codes.code import Code, cells_of, places_of
from renderer.directional.codes.harmonics import ringing
from renderer.directional.frames import quantised
from renderer.directional.hemisphere import Hemisphere, hemisphere_of
from renderer.directional.shadow_hemispheres import Caster, cosine_weights, shadow_bits, unpacked, world_directions
from renderer.directional.subject.mesh import solid_of
from renderer.directional.subject.relief import Relief
from renderer.directional.subject.solid import compact
from renderer.directional.subject.tree import Tree
from renderer.directional.subjects import bake_subject
from renderer.hemisphere_candidates import CANDIDATES
from renderer.world.mesh import load_mesh

Tell = Callable[[float, str], None]
Lines = list[dict[str, Any]]

SIZE = 2.0
"""Metres of a mesh's longest side: shadows do not depend on it."""

BETWEEN = 4000
"""Points at which random directions are cast."""

RAYS = 64
"""Random directions of each, spread evenly over its hemisphere."""

DENSE = 1024
"""Of each, spread by the cosine, by which openness is judged."""

LOW = 1 / 8.5
"""Part of a right angle that counts as grazing: the lowest row of 129 directions."""

CHUNK = 4096
"""Points read at once."""

FINER = 10_000
"""Most points of which 513 directions are coded."""


@dataclass(frozen=True)
class Cloud:
    """Points with the mesh that shades them.

    Attributes:
        name: for tables. positions, normals: (N, 3), as the GPU holds them. caster: their mesh.
    """

    name: str
    positions: np.ndarray
    normals: np.ndarray
    caster: Caster


def quiet(share: float, words: str) -> None:
    """Progress of what takes a moment."""


def clouds(mesh: Path | None, points: int) -> Iterator[Cloud]:
    """The user's mesh, where there is one, the built-in tree and the built-in relief.

    Raises:
        InputError: the mesh cannot be used.
    """
    if mesh is not None:
        try:
            solid = compact(solid_of(load_mesh(mesh)).stood(SIZE))
        except InputError as failure:
            raise failure.at("--mesh", ("file",)) from None
        own = {"vertices": solid.vertices, "faces": solid.faces, "normals": solid.shaded(), "colour": solid.colour,
               "two_sided": np.asarray(solid.two_sided)}
        yield _cloud(mesh.stem, own, points)
    for subject in (Tree(), Relief()):
        yield _cloud(subject.kind, bake_subject(bake_arguments(subject), {}, quiet), points)


def _cloud(name: str, subject: Arrays, points: int) -> Cloud:
    made = bake_cloud({"points": points}, {"subject": subject}, quiet)
    normals = quantised(made["normal"].astype(np.float64))
    return Cloud(name, made["position"], normals, Caster(subject["vertices"], subject["faces"]))


def code_lines(cloud: Cloud, count: int, masks: np.ndarray, tell: Tell) -> Lines:
    """What each code makes of masks (N, count).

    Returns:
        Of each code and size: bytes a point; `misjudged`, share of directions; `rms` of the clamped shadow function;
        `ringing`, share of values beyond 0 to 1 by more than a tenth, and `overshoot`, the worst; `irradiance`, mean
        absolute error of the cosine-weighted share; microseconds of one core to code a point.
    """
    layout = hemisphere_of(count)
    makers: dict[str, tuple[tuple[int, ...], Callable[[Hemisphere, int, np.ndarray], Code]]] = {
        kind: (CODE_SIZES[kind], make) for kind, make in MAKERS.items()
    }
    if count == 129:
        makers |= CANDIDATES
    wanted = [(kind, size, make) for kind, (sizes, make) in makers.items() for size in sizes]
    lines = []
    for number, (kind, size, make) in enumerate(wanted):
        tell(number / len(wanted), f"{cloud.name}, {count} directions: {kind} {size or ''}")
        start = time.process_time()
        code = make(layout, size, masks)
        words = code.encode(masks)
        spent = time.process_time() - start
        found = _read(code, words, cells_of(layout), masks)
        lines.append({
            "cloud": cloud.name, "points": len(masks), "directions": count, "code": kind, "bytes": code.size, **found,
            "coding_us": round(spent / len(masks) * 1e6, 2),
        })  # fmt: skip
    return lines


def _read(code: Code, words: np.ndarray, places: np.ndarray, masks: np.ndarray) -> dict[str, float]:
    wrong, square, rings, over, light = 0, 0.0, 0.0, 0.0, 0.0
    weights = cosine_weights(code.layout)
    for start in range(0, len(words), CHUNK):
        truth = masks[start : start + CHUNK]
        raw = code.evaluate(words[start : start + CHUNK], places)
        shown = np.clip(raw, 0, 1)
        wrong += int(((raw > 0.5) != truth).sum())
        square += float(((shown - truth) ** 2).sum())
        share, worst = ringing(raw)
        rings, over = rings + share * len(truth), max(over, worst)
        light += float(np.abs((shown - truth) @ weights).sum())
    cells = masks.size
    return {
        "misjudged": round(wrong / cells, 5), "rms": round(float(np.sqrt(square / cells)), 5),
        "ringing": round(rings / len(masks), 5), "overshoot": round(over, 3),
        "irradiance": round(light / len(masks), 5),
    }  # fmt: skip


def between_lines(cloud: Cloud, tell: Tell) -> Lines:
    """What masks and codes make of directions between those of the mask, against rays.

    Returns:
        Of 33 to 2,049 directions and of each way to read them: share misjudged, rms, and share misjudged of directions
        in the lowest eighth and a half of a right angle (`grazing`).
    """
    which = np.linspace(0, len(cloud.positions) - 1, min(BETWEEN, len(cloud.positions))).astype(int)
    positions, normals = cloud.positions[which], cloud.normals[which]
    local = spread(len(which), RAYS, cosine=False)
    truth = cloud.caster.open(positions, normals, world_directions(normals, local))
    grazing = local[..., 2] < np.sin(LOW * np.pi / 2)
    lines = []
    for count in (33, 129, 513, 2049):
        tell(count / 2100, f"{cloud.name}: between {count} directions")
        layout = hemisphere_of(count)
        masks = unpacked(shadow_bits(cloud.caster, positions, normals, layout, quiet)[0], count)
        ways: dict[str, Code] = {"nearest": Bits(layout, blend=False), "blended": Bits(layout)}
        if count in (129, 513):
            ways |= {kind: make(layout, 9, masks) for kind, make in MAKERS.items() if 9 in CODE_SIZES[kind]}
            ways["exact_harmonics"] = MAKERS["exact_harmonics"](layout, 0, masks)
        for name, code in ways.items():
            shown = np.clip(code.evaluate(code.encode(masks), places_of(layout, local)), 0, 1)
            wrong = (shown > 0.5) != truth
            lines.append({
                "cloud": cloud.name, "points": len(which), "rays": RAYS, "directions": count, "read": name,
                "misjudged": round(float(wrong.mean()), 5), "grazing": round(float(wrong[grazing].mean()), 5),
                "rms": round(float(np.sqrt(((shown - truth) ** 2).mean())), 5),
            })  # fmt: skip
    return lines


def openness_lines(cloud: Cloud) -> Lines:
    """Openness of 129 and 513 directions against `DENSE` rays spread by the cosine, whose own noise is taken off."""
    which = np.linspace(0, len(cloud.positions) - 1, min(BETWEEN // 2, len(cloud.positions))).astype(int)
    positions, normals = cloud.positions[which], cloud.normals[which]
    local = spread(len(which), DENSE, cosine=True)
    dense = cloud.caster.open(positions, normals, world_directions(normals, local)).mean(axis=1)
    noise = float((dense * (1 - dense) / DENSE).mean())
    lines = []
    for count in (129, 513):
        apart = shadow_bits(cloud.caster, positions, normals, hemisphere_of(count), quiet)[1] - dense
        rms = float(np.sqrt(max(float((apart**2).mean()) - noise, 0.0)))
        lines.append({"cloud": cloud.name, "points": len(which), "directions": count,
                      "bias": round(float(apart.mean()), 5), "rms": round(rms, 5)})  # fmt: skip
    return lines


def spread(points: int, rays: int, cosine: bool, seed: int = 7) -> np.ndarray:
    """Local directions (points, rays, 3) over the upper hemisphere, even or by the cosine."""
    rng = np.random.default_rng(seed)
    z = rng.random((points, rays))
    z = np.sqrt(z) if cosine else z
    turn, level = rng.random((points, rays)) * 2 * np.pi, np.sqrt(1 - z * z)
    return np.stack([level * np.cos(turn), level * np.sin(turn), z], axis=-1)


def measure(mesh: Path | None, points: int, tell: Tell) -> Mapping[str, Lines]:
    """Everything, as lines by part: `codes`, `between`, `openness`, `rays`.

    Raises:
        InputError: the mesh cannot be used.
    """
    parts: dict[str, Lines] = {"codes": [], "between": [], "openness": [], "rays": []}
    every = 3 if mesh is not None else 2
    for number, cloud in enumerate(clouds(mesh, points)):

        def part(low: float, high: float, first: float = number / every) -> Tell:
            return lambda share, words: tell(first + (low + (high - low) * share) / every, words)

        for count in (129, 513):
            some = slice(None) if count == 129 else slice(None, None, -(-len(cloud.positions) // FINER))
            start = time.process_time()
            bits, openness = shadow_bits(
                cloud.caster, cloud.positions[some], cloud.normals[some], hemisphere_of(count), part(0.0, 0.2)
            )
            spent = time.process_time() - start
            masks = unpacked(bits, count)
            parts["rays"].append({
                "cloud": cloud.name, "points": len(masks), "directions": count, "lit": round(float(masks.mean()), 4),
                "openness": round(float(openness.mean()), 4), "us_a_point": round(spent / len(masks) * 1e6, 2),
            })  # fmt: skip
            parts["codes"] += code_lines(cloud, count, masks, part(0.2, 0.7))
        parts["between"] += between_lines(cloud, part(0.7, 0.95))
        parts["openness"] += openness_lines(cloud)
    return parts
