"""Forests made by hand: bakes so simple that their pictures can be worked out, and one small grove."""

from __future__ import annotations

import inspect
import zlib
from collections.abc import Callable
from typing import Any

import numpy as np

from renderer.core.cache import key_of
from renderer.core.params import merge, validate
from renderer.core.registry import techniques
from renderer.core.technique import Arrays, Bake, BakedArrays
from renderer.forest import pattern_mips, seen_kernels, seen_levels
from renderer.forest.pattern import AXES, WOOD
from renderer.forest.pattern_mips import mips
from renderer.forest.safe_distance import safe_distance
from renderer.forest.state import ForestState
from renderer.forest.tiles import tile_table
from renderer.forest.world_scale import CELL, NODES, VOXEL
from renderer.world.sky_picture import VIEW_SHAPE

E_SUN = (3.0, 2.0, 1.0)
"""Irradiance of the sun in every hand-made world, W m-2, whatever its elevation."""

E_SKY = (1.0, 2.0, 4.0)
"""Irradiance of the sky on the horizontal wherever GLSL is asked on its own."""

GROUND = (0.3, 0.2, 0.1)
LAYERS, SIZE = 32, 256
RANK = 64
"""Of all hand-made trees: they stand where more than half of a stand does."""

UP = (128, 128, 255)
"""A normal that points up, as eight bits hold it: half a step off."""

Progress = Callable[[float, str], None]


def sky(radiance: tuple[float, float, float] = (1e-30, 1e-30, 1e-30)) -> dict[str, np.ndarray]:
    """The `sky` bake: one radiance [W m-2 sr-1] everywhere, black by default, and a sun of `E_SUN` at any elevation."""
    return {
        "elevations": np.array([-0.4, np.pi / 2]),
        "sun_irradiance": np.tile(E_SUN, (2, 1)).astype(np.float64),
        "sky_irradiance": np.pi * np.tile(radiance, (2, 1)),
        "radiance": np.broadcast_to(np.asarray(radiance, np.float64), (2, *VIEW_SHAPE, 3)),
    }


def ground(elevation: np.ndarray | float = 0.0, cover: np.ndarray | float = 1.0) -> dict[str, np.ndarray]:
    """The `terrain` bake: level and wooded by default; its surface carries no stands."""
    z = np.array(np.broadcast_to(np.asarray(elevation, np.float32), (NODES, NODES)))
    stands = np.array(np.broadcast_to(np.asarray(cover, np.float32), (NODES, NODES)))
    # Twice as fine as the nodes, each a yes or no: trees of rank 64 stand where the nearest node says so.
    presence = np.repeat(np.repeat(stands > 0.5, 2, axis=0), 2, axis=1) * np.uint8(255)
    return {"elevation": z, "cover": stands, "surface": z, "base": np.zeros(()), "presence": presence,
            "growth": np.ones((NODES, NODES), np.float32)}


def with_levels(level: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The finest level of a pattern and the coarser ones made of it."""
    coarser = {f"{name}_{n}": array for n, given in enumerate(mips(level), 1) for name, array in given.items()}
    return {**level, **coarser, **seen_levels.seen_levels(level, AXES, VOXEL, lambda share: None)}


def uniform(alpha: int, albedo: float = 0.5, ambient: int = 0, layers: slice = slice(None)) -> dict[str, np.ndarray]:
    """The `pattern` bake of a slab: one opacity (of 255, for one voxel's length) in the given layers, up-facing."""
    shape = (LAYERS, 32, 32)
    colour = np.zeros((*shape, 4), np.uint8)
    colour[layers] = (*(round(albedo * alpha),) * 3, alpha)
    anchor = np.full((*shape, 4), 128, np.uint8)
    full = np.arange(LAYERS)[layers] if alpha else np.array([1000])
    away = np.abs(np.arange(LAYERS)[:, None] - full).min(axis=1)
    # The ground counts as matter here: a longer skip would pass through a sharp brink unseen.
    anchor[..., 2], anchor[..., 3] = np.minimum(away, np.arange(LAYERS))[:, None, None], RANK
    normal = np.empty((*shape, 4), np.uint8)
    normal[...] = (*UP, ambient)
    level = {"colour": colour, "normal": normal, "anchor": anchor}
    return {**with_levels(level), "tile": tile_table(), "trees": np.zeros((0, 6), np.float32)}


def together(**arrays: Arrays) -> dict[str, BakedArrays]:
    """Bakes by name, each with a key of its content."""
    return {
        name: BakedArrays(key_of(name, *((k, zlib.crc32(np.ascontiguousarray(a).tobytes())) for k, a in made.items())),
                          made)
        for name, made in arrays.items()
    }


def state(**patch: Any) -> ForestState:
    """A forest's state: defaults, without sky behind it, changed by a merge patch."""
    level = {"albedo": list(GROUND), "tint_strength": 0.0, "patches": 0.0, "translucency": 0.0}
    given = {"view": {"background": "none"}, "ground": level}
    return validate(ForestState, merge(merge(ForestState().model_dump(mode="json"), given), patch))


def merged(patch: dict[str, Any], more: dict[str, Any]) -> ForestState:
    """The state of a patch with another one over it."""
    return validate(ForestState, merge(state(**patch).model_dump(mode="json"), more))


def sun(azimuth: float, elevation: float) -> dict[str, Any]:
    """The document's sun, degrees."""
    return {"kind": "direction", "azimuth": azimuth, "elevation": elevation}


def map_view(x: float, y: float, width: float) -> dict[str, Any]:
    """A parallel view straight down, north up, `width` metres wide."""
    return {"kind": "orthographic", "centre": [x, y, 0.0], "direction": [0, 0, -1], "up": [0, 1, 0], "width": width}


PINNED: dict[str, dict[str, Any]] = {
    "ray_march": {"step": 1.0, "stop": 0.02, "first": 1.0, "pitch": 1},
    "slices": {"count": 32, "correct_opacity": True},
    "horizon_map": {"sectors": 16, "height": 0.5, "softness": 9.0, "strength": 1.0},
    "double_horizon_map": {"sectors": 16, "height_top": 0.75, "height_low": 0.5, "softness": 3.0, "strength": 1.0},
    "horizon_volume": {"sectors": 8, "levels": 8, "highest": 0.85, "strength": 1.0},
    "depth_shadow_map": {"resolution": 1024, "threshold": 0.3, "bias": 0.75, "strength": 1.0},
    "fourier_opacity_map": {"resolution": 512, "coefficients": 15, "level": 0.0, "damping": 0.0, "strength": 1.0},
    "sun_march": {"step": 1.0, "growth": 0.4, "bias": -1.5, "stop": 0.02, "blocks": 1},
    "voxel_transmittance": {"coefficients": 16, "strength": 1.0},
    "empirical": {"strength": 1.0, "foot": 0.5, "rise": 1.0},
    "gouraud": {"strength": 1.0},
    "lafortune": {"coefficients": "averaged"},
    "constant": {"tint": (0.3, 0.5, 0.6), "share": 0.3},
    "mipmap": {"bias": 0.0},
}
"""Parameters of the techniques in every hand-made world, so that tuned defaults leave measured costs alone."""


def technique(slot: str, kind: str, **parameters: Any) -> dict[str, Any]:
    """A technique's whole document, whatever the scene's defaults are."""
    made = techniques("forest", slot)[kind](kind=kind, **{**PINNED.get(kind, {}), **parameters})
    return made.model_dump(mode="json")


PLAIN = {
    slot: technique(slot, kind)
    for slot, kind in {"geometry": "ray_march", "shadow": "none", "height_shading": "none", "light": "leaf",
                       "sky": "ambient", "filter": "none"}.items()
}
"""Techniques that add nothing of their own; a test puts the one it is about in its slot."""


def with_technique(slot: str, kind: str, **parameters: Any) -> dict[str, Any]:
    """`PLAIN` with one technique in its place."""
    return {**PLAIN, slot: technique(slot, kind, **parameters)}


# A grove: round crowns on two hills, beside a glade. It is what techniques are held to the reference on.

def grove_ground(arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Progress) -> Arrays:
    """Two low hills, and a square glade whose edge falls on borders of the map of trees, so that it costs nothing."""
    x = (np.arange(NODES) - (NODES - 1) / 2) * CELL
    east, north = np.meshgrid(x, -x)
    z = 14 * (1 + np.sin(east / 60) * np.cos(north / 75)) + 10 * (1 + np.sin((east + north) / 210))
    cover = np.where((np.abs(east - 45) < 30) & (np.abs(north) < 30), 0.0, 1.0)
    made = ground(z.astype(np.float32), cover.astype(np.float32))
    return {**made, "surface": made["elevation"] + np.float32(15) * (made["cover"] > 0.5)}


def grove_pattern(arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Progress) -> Arrays:
    """Ellipsoidal crowns on trunks, six to a triangle, none across an edge."""
    rng = np.random.default_rng(5)
    colour, normal, anchor = (np.zeros((LAYERS, SIZE, SIZE, 4), np.uint8) for _ in range(3))
    normal[...], anchor[...] = (*UP, 150), (128, 128, 0, RANK)
    height = ((np.arange(LAYERS) + 0.5) * VOXEL)[:, None, None]
    for p, q, n in np.ndindex(4, 4, 12):
        # Places in the upward triangle; its mirror image in the downward one.
        u, v = [(0.16, 0.16), (0.16, 0.4), (0.16, 0.66), (0.4, 0.16), (0.4, 0.4), (0.66, 0.16)][n % 6]
        u, v = (u, v) if n < 6 else (1 - u, 1 - v)
        foot = (np.array([p + u, q + v]) + rng.uniform(-0.02, 0.02, 2)) * SIZE / 4
        top, radius, shade = rng.uniform(11, 17), rng.uniform(3.4, 4.8), rng.uniform(0.05, 0.2)
        i, j = (np.arange(int(foot[axis]) - 9, int(foot[axis]) + 11) for axis in (0, 1))
        du, dv = (i[None, None, :] + 0.5 - foot[0]) * VOXEL, (j[None, :, None] + 0.5 - foot[1]) * VOXEL
        x, y = du + 0.5 * dv + 0 * height, np.sqrt(0.75) * dv + 0 * height + 0 * du
        out = np.stack([x / radius, y / radius, (height - 0.62 * top) / (0.4 * top) + 0 * x], axis=-1)
        inside = (out**2).sum(axis=-1) < 1
        trunk = (np.hypot(x, y) < 0.6) & (height + 0 * x < 0.5 * top)
        here = np.ix_(range(LAYERS), j % SIZE, i % SIZE)
        opacity = np.where(inside, rng.integers(10, 140, inside.shape), np.where(trunk, 255, 0))
        full = opacity > 0
        length = np.maximum(np.linalg.norm(out, axis=-1, keepdims=True), 1e-6)
        albedo = np.where(inside[..., None], shade * np.array([0.7, 1.0, 0.4]), 0.1)
        block = np.concatenate([np.rint(albedo * opacity[..., None]), opacity[..., None]], axis=-1)
        near = (out**2).sum(axis=-1) < 1.9
        feet = np.stack([128 - 16 * x, 128 - 16 * y], axis=-1)
        colour[here] = np.where(full[..., None], block, colour[here])
        # A crown's leaves agree in part; its wood lets no light through.
        mean = 100 * out / length + 128
        normal[here] = np.where(near[..., None], np.concatenate([mean, 90 + 80 * near[..., None]], axis=-1),
                                normal[here])
        anchor[here] = np.where(near[..., None] | full[..., None],
                                np.concatenate([np.clip(np.rint(feet), 0, 255), 0 * feet[..., :1],
                                                np.where(trunk & ~inside, RANK + WOOD, RANK)[..., None]], axis=-1),
                                anchor[here])
    anchor[..., 2] = safe_distance(colour[..., 3] > 0)
    level = {"colour": colour, "normal": normal, "anchor": anchor}
    coarser = {f"{name}_{n}": array for n, given in enumerate(mips(level), 1) for name, array in given.items()}
    return {**level, **coarser, "tile": tile_table(), "trees": np.zeros((0, 6), np.float32)}


def grove_levels(arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Progress) -> Arrays:
    """The grove's pattern with all its levels."""
    pattern = grove_pattern(arguments, inputs, progress)
    return {**pattern, **seen_levels.seen_levels(pattern, AXES, VOXEL, lambda share: None)}


VERSION = zlib.crc32("".join(map(inspect.getsource, (grove_ground, grove_pattern))).encode())
"""Of the grove: its bakes and its references are made anew when it changes."""

LEVELS = zlib.crc32("".join(map(inspect.getsource, (pattern_mips, seen_kernels, seen_levels))).encode())
"""Of what makes its coarser levels: these are baked anew when that changes; no reference reads them."""

GROVE_GROUND = Bake("terrain", grove_ground, {}, version=VERSION)
GROVE_PATTERN = Bake("pattern", grove_levels, {"levels": LEVELS}, version=VERSION)
