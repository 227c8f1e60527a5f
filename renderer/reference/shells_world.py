"""The shells' world as the reference reads it: plain arrays in, tables for its compiled functions out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from renderer.core.errors import InputError

Floats = NDArray[np.float64]
Colour3 = tuple[float, float, float]

NEAREST, STRAIGHT, EXTINCTION = 0, 1, 2
"""How a texture is read between its voxels' centres."""

UNLIT, LAMBERT, SCATTERING = 0, 1, 2
"""What matter sends towards the eye."""

OPAQUEST = 1.0 - 2.0**-12
"""Largest alpha that has an extinction."""

LEAF = 4
"""Most solids or faces in a leaf of a tree of boxes."""


@dataclass(frozen=True)
class Surface:
    """Opaque triangles, Lambert's on both sides.

    Attributes:
        corners: (F, 3, 3) metres.
        albedo: (F, 3, 3) linear reflectance at the corners, linear between them; multiplied by `picture`, where one is.
        normals: (F, 3, 3) at the corners, linear between them; None takes each face's own.
        uv: (F, 3, 2) where the corners lie in `picture`.
        picture: (H, W, 3) linear reflectance, row 0 at v = 0, texel centres at (i + 0.5) / W; it repeats.
        globe: whether it is laid on by longitude and latitude round the origin instead, from 180 degrees west and the
            south pole on, `uv` being added to their shares; it then ends at the poles.
    """

    corners: NDArray[np.floating]
    albedo: NDArray[np.floating]
    normals: NDArray[np.floating] | None = None
    uv: NDArray[np.floating] | None = None
    picture: NDArray[np.floating] | None = None
    globe: bool = False


@dataclass(frozen=True)
class ShellsWorld:
    """What stands where, in metres, z up, and the light it stands in.

    Attributes:
        positions: (P, 3) of the tetrahedra's corners; tets: (T, 4) of them; texture: (T, 4, 3), (u, v, w) there.
        colour: (K, J, I, 4) straight linear reflectance, and alpha for a way of `reference_length` metres; k is along
            w, j along v, i along u; centres at (i + 0.5) / I.
        normal: (K, J, I, 4) unit normal in a box of sides `size`, 0 without a surface; fourth, the share of
            `glow_radiance` that the voxel sends; None for matter without either.
        interpolation: piecewise constant; trilinear colour and alpha; or trilinear extinction and its products.
        wrap: of the texture in u and v; it is clamped in w.
        light: `unlit`: reflectance times `level`; `lambert`: by sun and sky; `scattering`: every order of scattering
            by Henyey and Greenstein's lobe of mean cosine `asymmetry`, reflectance (at most 1) being the share that is
            scattered, normals left unread.
        sun: unit vector to it. e_sun: irradiance facing it. e_sky: of the sky on the horizontal. All W m-2.
        shadows: whether they fall, where light is not scattered on.
        surfaces: opaque things; the shells' own base among them where it is opaque.
        background: radiance behind everything, for directions (M, 3) -> (M, 3); None leaves it empty.
    """

    positions: NDArray[np.floating]
    tets: NDArray[np.integer]
    texture: NDArray[np.floating]
    colour: NDArray[np.floating]
    reference_length: float
    normal: NDArray[np.floating] | None = None
    size: Colour3 = (1.0, 1.0, 1.0)
    interpolation: Literal["nearest", "straight", "extinction"] = "extinction"
    wrap: Literal["repeat", "clamp"] = "repeat"
    light: Literal["unlit", "lambert", "scattering"] = "unlit"
    level: float = 1.0
    glow_radiance: Colour3 = (0.0, 0.0, 0.0)
    sun: Colour3 = (0.0, 0.0, 1.0)
    e_sun: Colour3 = (0.0, 0.0, 0.0)
    e_sky: Colour3 = (0.0, 0.0, 0.0)
    sky_below: float = 0.0
    asymmetry: float = 0.0
    shadows: bool = True
    surfaces: tuple[Surface, ...] = field(default=())
    background: Callable[[Floats], Floats] | None = None


class Tree(NamedTuple):
    """Boxes of boxes: children of node n are 2n + 1 and 2n + 2, all leaves on one level.

    Attributes:
        boxes: (N, 6), lowest and highest corner; an empty one has its lowest above its highest.
        order: members as the leaves hold them, `LEAF` in each, the last perhaps fewer.
    """

    boxes: Floats
    order: NDArray[np.int64]


class Scene(NamedTuple):
    """A world in tables.

    Attributes:
        solids: tree of the tetrahedra. planes: (T, 4, 4), n.x + d > 0 outside. maps: (T, 3, 4) to voxels, centres at
            whole numbers where interpolated, at halves elsewhere. turns: (T, 3, 3) from the texture's normals to the
            world's, not unit.
        density: (K, J, I) extinction, 1/m; alpha where that is interpolated. occupied: (K + 1, J + 1, I + 1) whether
            there is any at the corners of the cells between eight centres, the first before the first centre.
        colour: (K, J, I, 3). normal: (K, J, I, 4), or of one voxel where there is none.
        faces: tree of the triangles. corners, normals, albedo: (F, 3, 3). uv: (F, 3, 2). pictures: (F, 4), where its
            texels begin, rows, columns, 0 rows for none, whether it is a globe's. texels: (N, 3) of all pictures.
        numbers: reference length, level, how far off a face a ray begins. lights: (4, 3), sun, e_sun, e_sky, glow.
        kinds: interpolation, light, whether the texture repeats, whether it has normals, whether shadows fall.
    """

    solids: Tree
    planes: Floats
    maps: Floats
    turns: Floats
    density: Floats
    occupied: NDArray[np.uint8]
    colour: Floats
    normal: NDArray[np.float32]
    faces: Tree
    corners: Floats
    normals: Floats
    albedo: Floats
    uv: Floats
    pictures: NDArray[np.int64]
    texels: Floats
    numbers: Floats
    lights: Floats
    kinds: NDArray[np.int64]


def prepare(world: ShellsWorld) -> Scene:
    """Tables of a world; solids without volume are left out.

    Raises:
        InputError: arrays that do not fit.
    """
    _check(world)
    corners = np.asarray(world.positions, np.float64)[np.asarray(world.tets)].reshape(-1, 4, 3)
    texture = np.asarray(world.texture, np.float64).reshape(-1, 4, 3)
    edges = corners[:, 1:] - corners[:, :1]
    volume = np.linalg.det(edges)
    whole = np.abs(volume) > 1e-14 * np.prod(np.linalg.norm(edges, axis=2), axis=1)
    corners, texture = corners[whole], texture[whole]
    linear = np.swapaxes(np.linalg.solve(edges[whole], texture[:, 1:] - texture[:, :1]), 1, 2)  # (T, uvw, xyz)
    shift = texture[:, 0] - np.einsum("tij,tj->ti", linear, corners[:, 0])
    counts = np.array(world.colour.shape[2::-1], np.float64)
    smooth = world.interpolation != "nearest"
    maps = np.concatenate([linear, shift[..., None]], axis=2) * counts[:, None]
    maps[..., 3] -= 0.5 if smooth else 0.0
    alpha = np.asarray(world.colour[..., 3], np.float64)
    density = alpha if world.interpolation == "straight" else extinction(alpha, world.reference_length)
    faces, pictures = _opaque(world.surfaces)
    everything = np.concatenate([corners.reshape(-1, 3), faces["corners"].reshape(-1, 3)])
    span = float(np.ptp(everything, axis=0).max()) + float(np.abs(everything).max()) if len(everything) else 1.0
    normal = np.zeros((1, 1, 1, 4)) if world.normal is None else world.normal
    return Scene(
        solids=tree(corners.min(axis=1), corners.max(axis=1), 1e-12 * span),
        planes=_planes(corners),
        maps=np.ascontiguousarray(maps),
        turns=np.ascontiguousarray(np.swapaxes(linear, 1, 2) * np.asarray(world.size, np.float64)),
        # copied: a frozen array would be one more type to compile for
        density=np.array(density, np.float64, order="C"),
        occupied=_occupied(density, world.wrap == "repeat") if smooth else np.zeros((1, 1, 1), np.uint8),
        colour=np.array(world.colour[..., :3], np.float64, order="C"),
        normal=np.array(normal, np.float32, order="C"),
        faces=tree(faces["corners"].min(axis=1), faces["corners"].max(axis=1), 1e-12 * span),
        **faces,
        pictures=pictures,
        numbers=np.array([world.reference_length, world.level, 1e-10 * span]),
        lights=np.array([world.sun, world.e_sun, world.e_sky, world.glow_radiance], np.float64),
        kinds=np.array([
            {"nearest": NEAREST, "straight": STRAIGHT, "extinction": EXTINCTION}[world.interpolation],
            {"unlit": UNLIT, "lambert": LAMBERT, "scattering": SCATTERING}[world.light],
            world.wrap == "repeat",
            world.normal is not None,
            world.shadows,
        ], np.int64),
    )  # fmt: skip


def extinction(alpha: Floats, length: float) -> Floats:
    """Extinction per metre of matter that hides `alpha` of what is behind `length` metres of it (formulas g)."""
    return -np.log1p(-np.minimum(alpha, OPAQUEST)) / length


def _occupied(density: Floats, repeats: bool) -> NDArray[np.uint8]:
    """Whether anything is at the corners of the cells between eight centres."""
    there = np.pad(density > 0, ((0, 0), (1, 1), (1, 1)), mode="wrap" if repeats else "edge")
    there = np.pad(there, ((1, 1), (0, 0), (0, 0)), mode="edge")
    for axis in range(3):
        first, last = (np.take(there, np.arange(n, there.shape[axis] - 1 + n), axis=axis) for n in (0, 1))
        there = first | last
    return np.ascontiguousarray(there, np.uint8)


def _check(world: ShellsWorld) -> None:
    count = len(world.tets)
    if world.tets.shape != (count, 4) or np.any((world.tets < 0) | (world.tets >= len(world.positions))):
        raise InputError("tets", f"has shape {world.tets.shape} or names a corner that is not there", "(T, 4)")
    if world.texture.shape != (count, 4, 3):
        raise InputError("texture", f"has shape {world.texture.shape}", f"({count}, 4, 3)")
    if world.colour.ndim != 4 or world.colour.shape[3] != 4 or not world.colour.size:
        raise InputError("colour", f"has shape {world.colour.shape}", "(K, J, I, 4)")
    if world.normal is not None and world.normal.shape != world.colour.shape:
        raise InputError("normal", f"has shape {world.normal.shape}", f"{world.colour.shape}, as colour has")
    if not world.reference_length > 0:
        raise InputError("reference_length", f"is {world.reference_length}", "metres above 0")
    if not -1 < world.asymmetry < 1:
        raise InputError("asymmetry", f"is {world.asymmetry}", "between -1 and 1")
    if abs(float(np.linalg.norm(world.sun)) - 1.0) > 1e-6:
        raise InputError("sun", "is no unit vector")


def _planes(corners: Floats) -> Floats:
    """Plane of the face opposite each corner, unit normal outward, (T, 4, 4)."""
    found = np.zeros((len(corners), 4, 4))
    for k in range(4):
        a, b, c = (corners[:, j] for j in range(4) if j != k)
        normal = np.cross(b - a, c - a)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        # the face's middle: the plane's constant then errs evenly over the face
        offset = -np.einsum("ti,ti->t", normal, (a + b + c) / 3)
        inside = np.einsum("ti,ti->t", normal, corners[:, k]) + offset
        found[:, k] = np.concatenate([normal, offset[:, None]], axis=1) * -np.sign(inside)[:, None]
    return found


def _opaque(surfaces: tuple[Surface, ...]) -> tuple[dict[str, Floats], NDArray[np.int64]]:
    """Tables of all triangles, and where their pictures are."""
    corners, normals, albedo, uv, pictures, texels = [], [], [], [], [], [np.zeros((0, 3))]
    begin = 0
    for surface in surfaces:
        one = np.asarray(surface.corners, np.float64).reshape(-1, 3, 3)
        flat = np.cross(one[:, 1] - one[:, 0], one[:, 2] - one[:, 0])
        whole = np.linalg.norm(flat, axis=1) > 0
        own = np.repeat(flat[:, None], 3, axis=1) if surface.normals is None else np.asarray(surface.normals)
        corners.append(one[whole])
        normals.append(np.asarray(own, np.float64)[whole])
        albedo.append(np.broadcast_to(np.asarray(surface.albedo, np.float64), one.shape)[whole])
        uv.append(np.zeros((len(one), 3, 2))[whole] if surface.uv is None else np.asarray(surface.uv, float)[whole])
        shape = (0, 0) if surface.picture is None else surface.picture.shape[:2]
        pictures.append(np.tile(np.array([begin, *shape, surface.globe], np.int64), (int(whole.sum()), 1)))
        if surface.picture is not None:
            texels.append(np.asarray(surface.picture, np.float64).reshape(-1, 3))
            begin += len(texels[-1])
    nothing = np.zeros((0, 3, 3))
    return {
        "corners": np.concatenate([nothing, *corners]),
        "normals": np.concatenate([nothing, *normals]),
        "albedo": np.concatenate([nothing, *albedo]),
        "uv": np.concatenate([nothing[..., :2], *uv]),
        "texels": np.concatenate(texels),
    }, np.concatenate([np.zeros((0, 4), np.int64), *pictures])


def tree(low: Floats, high: Floats, margin: float) -> Tree:
    """Tree of boxes over members along Morton's curve through their middles (Morton 1966).

    Args:
        low, high: (M, 3) of each member. margin: added around each box, for rounding.
    """
    count = len(low)
    leaves = 1
    while leaves * LEAF < count:
        leaves *= 2
    boxes = np.zeros((2 * leaves - 1, 6))
    boxes[:, :3], boxes[:, 3:] = np.inf, -np.inf
    if not count:
        return Tree(boxes, np.zeros(0, np.int64))
    middle = 0.5 * (low + high)
    span = np.maximum(np.ptp(middle, axis=0), 1e-300)
    cells = np.minimum((middle - middle.min(axis=0)) / span * 1024, 1023).astype(np.int64)
    code = np.zeros(count, np.int64)
    for bit in range(10):
        for axis in range(3):
            code |= ((cells[:, axis] >> bit) & 1) << (3 * bit + axis)
    order = np.argsort(code, kind="stable")
    padded = np.full((leaves * LEAF, 6), np.inf)
    padded[:, 3:] = -np.inf
    padded[:count, :3], padded[:count, 3:] = low[order] - margin, high[order] + margin
    level = padded.reshape(leaves, LEAF, 6)
    first = leaves - 1
    while True:
        joined = np.concatenate([level[..., :3].min(axis=1), level[..., 3:].max(axis=1)], axis=1)
        boxes[first : first + len(joined)] = joined
        if first == 0:
            return Tree(boxes, order)
        level, first = joined.reshape(-1, 2, 6), (first - 1) // 2
