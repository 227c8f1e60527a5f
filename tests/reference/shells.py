"""Shells simple enough to work out by hand, the reference's own, and rays to look at them."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from renderer.reference.shells_world import ShellsWorld

Looking = Callable[[tuple[float, float]], tuple[np.ndarray, np.ndarray]]

CENTRE = np.array([[0.5, 0.5]])
SHARED = Path(__file__).parents[2].parent / "shared" / "reference"
PRISMS = json.loads((Path(__file__).parents[1] / "references" / "shells" / "prisms.json").read_text())

PIXELS = ((51, 80), (87, 66), (84, 47), (44, 115), (44, 108), (29, 86), (73, 79), (84, 90))
VALUES = {
    "nearest": np.array([
        [0.01266993, 0.021250019, 0.022615146, 0.02374281],
        [0.35806847, 0.85869294, 0.63213944, 0.99984056],
        [0.77449822, 0.90675217, 0.25794524, 0.99997926],
        [0.35232824, 0.45570982, 0.3275997, 0.81880677],
        [0.42674914, 0.55196762, 0.39679727, 0.99176008],
        [0.52232188, 0.10486718, 0.31441513, 0.58694983],
        [0.4481158, 0.24128735, 0.30281237, 0.9575485],
        [0.078880548, 0.5859952, 0.13249901, 0.63283992],
    ]),
    "extinction": np.array([
        [0.029655911, 0.049738925, 0.052934211, 0.055573683],
        [0.35777822, 0.85711598, 0.63136142, 0.99983042],
        [0.77441108, 0.90658802, 0.25816229, 0.99997801],
        [0.35253417, 0.45597619, 0.32779118, 0.81928539],
        [0.426673, 0.55186909, 0.39672649, 0.99158311],
        [0.51814878, 0.10402933, 0.31190306, 0.58226031],
        [0.45073447, 0.2459289, 0.30511245, 0.95764142],
        [0.078359932, 0.58212763, 0.1316245, 0.62866312],
    ]),
    "straight": np.array([
        [0.012967621, 0.021749308, 0.023146508, 0.053884078],
        [0.35589841, 0.85307407, 0.62818331, 0.9998216],
        [0.77335668, 0.90532529, 0.25790492, 0.99997759],
        [0.35219517, 0.45553771, 0.32747597, 0.81849754],
        [0.42663017, 0.55181372, 0.39668667, 0.99150789],
        [0.51568139, 0.10353395, 0.3104178, 0.58068073],
        [0.44368437, 0.23943761, 0.2999059, 0.95585245],
        [0.077816725, 0.57809216, 0.13071205, 0.62705195],
    ]),
}
"""Radiance and opacity of the heterogeneous volume at `PIXELS`, from `d_volume_images.npz` of the shared folder."""


def extrude(base: np.ndarray, faces: Any, offset: Any) -> tuple[np.ndarray, np.ndarray]:
    """Corners and tetrahedra of a shell: each triangle a prism, each prism three tetrahedra (Dufort 2005, 3.1)."""
    base, count = np.asarray(base, float), len(base)
    tets = []
    for face in faces:
        a, b, c = sorted(face)
        tets += [(a, b, c, c + count), (a, b, b + count, c + count), (a, a + count, b + count, c + count)]
    return np.concatenate([base, base + np.asarray(offset, float)]), np.array(tets)


def slab(
    rgba: Any, length: float = 1.0, sides: Any = (1.0, 1.0, 0.5), origin: Any = (0.0, 0.0, 0.0), lean: Any = (0.0, 0.0),
    **changes: Any,
) -> ShellsWorld:
    """A level box of two prisms, its top shifted by `lean`, with the texture over all of it."""
    x, y, z = sides
    square = np.array([[0, 0, 0], [x, 0, 0], [x, y, 0], [0, y, 0]], float) + origin
    positions, tets = extrude(square, ((0, 1, 2), (0, 2, 3)), (*lean, z))
    place = np.concatenate([square - origin, square - origin + [0, 0, z]]) / sides
    colour = np.asarray(rgba, float)
    if colour.ndim == 1:
        colour = colour.reshape(1, 1, 1, 4)
    given: dict[str, Any] = {"positions": positions, "tets": tets, "texture": place[tets], "colour": colour,
                             "reference_length": length, "size": tuple(sides), "wrap": "clamp",
                             "interpolation": "nearest", **changes}  # fmt: skip
    return ShellsWorld(**given)


def alpha(extinction: float, length: float = 1.0) -> float:
    """Alpha of matter of an extinction, for a way of `length`."""
    return float(-np.expm1(-extinction * length))


def joined(*worlds: ShellsWorld) -> ShellsWorld:
    """The solids of several worlds in the texture of the first."""
    first = worlds[0].positions.shape[0]
    assert all(len(world.positions) == first for world in worlds)
    return ShellsWorld(
        np.concatenate([world.positions for world in worlds]),
        np.concatenate([world.tets + first * k for k, world in enumerate(worlds)]),
        np.concatenate([world.texture for world in worlds]),
        worlds[0].colour,
        worlds[0].reference_length,
        interpolation=worlds[0].interpolation,
        wrap=worlds[0].wrap,
    )


def beams(origins: Any, directions: Any) -> Looking:
    """Rays of a picture of one row, one a pixel."""
    o, d = np.atleast_2d(np.asarray(origins, float)), np.atleast_2d(np.asarray(directions, float))
    d = np.broadcast_to(d / np.linalg.norm(d, axis=1, keepdims=True), o.shape)
    return lambda place: (o[None], d[None])


def prisms(name: str) -> tuple[ShellsWorld, Looking, np.ndarray]:
    """A set of the shared prisms: each of one voxel of the texture; its rays; radiance and opacity along them."""
    materials, found = PRISMS["materials"], PRISMS["sets"][name]
    corners = np.array([prism["vertices"] for prism in found["prisms"]])
    tets = np.array([[6 * k + n for n in tet] for k in range(3) for tet in ((0, 1, 2, 5), (0, 1, 4, 5), (0, 3, 4, 5))])
    place = np.broadcast_to([0.0, 0.5, 0.5], (9, 4, 3)).copy()
    place[..., 0] = (np.arange(9) // 3 + 0.5)[:, None] / 3
    colour = np.array([[*m["color"], alpha(m["sigma"], 0.1)] for m in materials]).reshape(1, 1, 3, 4)
    world = ShellsWorld(corners.reshape(-1, 3), tets, place, colour, 0.1, interpolation="nearest", wrap="clamp")
    rays = found["rays"]
    right = np.array([[*ray["rgb"], ray["alpha"]] for ray in rays])
    return world, beams([ray["o"] for ray in rays], [ray["d"] for ray in rays]), right


def volume() -> np.ndarray:
    """The heterogeneous volume of the shared references, (32, 64, 64, 4), by its recipe."""
    rng, count = np.random.Generator(np.random.PCG64(12345)), 24
    centre = rng.random((count, 3)) * [1, 1, 0.5]
    radius = 0.05 + 0.10 * rng.random(count)
    colour = 0.1 + 0.9 * rng.random((count, 3))
    amplitude = 20 + 60 * rng.random(count)
    z, y, x = np.meshgrid(*((np.arange(n) + 0.5) / 64 for n in (32, 64, 64)), indexing="ij")
    away = ((np.stack([x, y, z], axis=-1)[..., None, :] - centre) ** 2).sum(axis=-1)
    each = amplitude * np.maximum(0, 1 - away / radius**2) ** 2
    total = each.sum(axis=-1)
    assert abs(total.sum() / 284866.46970793273 - 1) < 1e-12, "the recipe's check sum"
    mixed = each @ colour / np.maximum(total, 1e-300)[..., None]
    return np.concatenate([mixed, -np.expm1(-total / 64)[..., None]], axis=-1)


def volume_camera(rows: Any, columns: Any) -> Looking:
    """Rays of `d_volume.json` through pixels of its picture of 128 a side."""
    w = np.array([0.4504281101536532, 0.6005708135382042, -0.6606278948920247])
    u = np.array([0.7999999999999999, -0.6, 0.0])
    v = np.array([0.3963767369352148, 0.5285023159136197, 0.7507135169227552])
    i, j = np.asarray(rows, float), np.asarray(columns, float)

    def looking(place: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
        across, up = (j + place[0]) / 128 - 0.5, 0.5 - (i + place[1]) / 128
        origins = np.array([0.5, 0.5, 0.25]) - 2 * w + 1.4 * (across[..., None] * u + up[..., None] * v)
        return origins, np.broadcast_to(w, origins.shape)

    return looking
