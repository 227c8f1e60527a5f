"""Four views of the forest that isolate its kinds of shadow, and the techniques that are compared in them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from renderer.core.isolation import Contender, Isolation
from renderer.core.registry import techniques
from renderer.core.technique import Arrays, Preset
from renderer.forest.combinations import COMBINATIONS, EMPIRICAL, FINE, NO_HEIGHT, THESIS_MAPS

if TYPE_CHECKING:
    from renderer.forest.state import ForestState

GROUP = "One kind of shadow"

TARGET_BYTES = 4
"""Of a texel that a pass from the sun draws, one float."""


def _view(title: str, look_at: str, camera: Mapping[str, Any], sun: tuple[float, float], exposure: float) -> Preset:
    patch = {
        "camera": dict(camera),
        "sun": {"kind": "direction", "azimuth": sun[0], "elevation": sun[1]},
        "view": {"exposure": exposure},
    }
    return Preset(title, look_at, patch, GROUP)


VIEWS = {
    "shadow_land": _view(
        "Shadow: land on forest",
        "Look at the edge of the ridge's shadow on the far slope: all below it lies in the land's own shade.",
        {"kind": "orbit", "target": [1120, 150, 120], "distance": 900, "azimuth": 268, "elevation": 22},
        (272, 12),
        0.0,
    ),
    "shadow_ground": _view(
        "Shadow: forest on ground",
        "Look at the glade from above: the trees along its sunny side throw their shapes on bare ground.",
        {
            "kind": "orthographic",
            "centre": [975, 350, 90],
            "direction": [0, 0, -1],
            "up": [0, 1, 0],
            "width": 150,
        },
        (200, 30),
        0.6,
    ),
    "shadow_tree": _view(
        "Shadow: tree on tree",
        "Look between the crowns: each one's lower half, away from the low sun, lies in its neighbours' shade.",
        {"kind": "orbit", "target": [1150, -300, 265], "distance": 260, "azimuth": 305, "elevation": 35},
        (255, 16),
        0.4,
    ),
    "shadow_within": _view(
        "Shadow: within a tree",
        "Look at single crowns at the forest's edge: under a high sun the upper leaves shade the lower ones.",
        {"kind": "look", "eye": [964, 306, 88], "target": [975, 420, 84]},
        (200, 70),
        1.0,
    ),
}
"""Presets, each under the sun that makes its kind of shadow the largest."""

ISOLATIONS = (
    Isolation("land", "terrain on forest", "terrain", "shadow_land"),
    Isolation("ground", "forest on ground", "forest_on_ground", "shadow_ground"),
    Isolation("tree", "tree on tree", "tree_on_tree", "shadow_tree"),
    Isolation("within", "within a tree", "within_tree", "shadow_within"),
    Isolation("combined", "all kinds at once", "", "valley_sunset"),
)
"""Columns of the table; the last has no mask."""

COMMON: Mapping[str, Any] = {
    "height_shading": NO_HEIGHT,
    "light": {"kind": "leaf"},
    "sky": {"kind": "ambient"},
    **FINE,
}
"""What all shadow techniques are judged with: leaves and the sky's share as the reference has them, rays too fine to
err themselves, and no empirical shading, which darkens even exact shadows."""

SWEPT: Mapping[str, tuple[str, tuple[int, ...]]] = {
    "horizon_map": ("sectors", (4, 8, 16, 32)),
    "double_horizon_map": ("sectors", (4, 8, 16, 32)),
    "horizon_volume": ("sectors", (4, 8, 16, 32)),
    "depth_shadow_map": ("resolution", (512, 2048)),
    "perspective_shadow_map": ("resolution", (512, 2048)),
}
"""Techniques that have a row for each of several settings; all others have one, at their defaults."""


def contenders() -> tuple[Contender, ...]:
    """Every shadow technique at its settings, the horizon maps with the empirical shading that the thesis gives them,
    and the named combinations."""
    found = []
    for kind in techniques("forest", "shadow"):
        name, values = SWEPT.get(kind, ("", ()))
        for value in values:
            found.append(Contender(f"{kind}, {value}", {"shadow": {"kind": kind, name: value}}))
        if not values:
            found.append(Contender(kind, {"shadow": {"kind": kind}}))
    one, two = ({"kind": kind, **THESIS_MAPS} for kind in ("horizon_map", "double_horizon_map"))
    found += [
        Contender("horizon_map, 4 + empirical", {"shadow": one, "height_shading": EMPIRICAL}),
        Contender("double_horizon_map, thesis", {"shadow": two}),
        Contender("double_horizon_map, thesis + empirical", {"shadow": two, "height_shading": EMPIRICAL}),
    ]
    found += [Contender(f"combination: {name}", entry.patch, True) for name, entry in COMBINATIONS.items()]
    return tuple(found)


def held_bytes(state: ForestState, baked: Mapping[str, Arrays], size: tuple[int, int]) -> int:
    """Bytes on the GPU that a state's techniques hold beside the ground and the pattern, for a picture of `size`."""
    arrays: list[np.ndarray] = []
    targets = 0
    for technique in state.techniques().values():
        if technique.frame_key(state):
            arrays += technique.frame_textures(state, baked).values()
        for levels in technique.kept_textures(state, baked).values():
            arrays += levels
        seen_from_sun = technique.sun_pass(state, baked, size)
        if seen_from_sun is not None:
            targets += TARGET_BYTES * seen_from_sun.resolution**2 * seen_from_sun.layers
    # doubles become floats on their way
    return targets + sum(array.size * min(array.itemsize, TARGET_BYTES) for array in arrays)
