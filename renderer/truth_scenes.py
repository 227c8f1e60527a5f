"""How each scene's reference is asked for: what of a state it depends on, and its world as a reference picture.

Apart from `renderer.truth`, which keeps references as it keeps any other precomputation.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from renderer.core.technique import Arrays

if TYPE_CHECKING:
    from renderer.truth import Judge, Progress

SKY_RAYS = 576
"""Rays of a pixel of the directional textures' reference that look for the sky, whatever the number of positions."""

FOREST_SHADOWS = ("terrain", "forest_on_ground", "tree_on_tree", "within_tree")
"""Kinds of shadow that the forest's reference can leave out."""


def _forest_options(state: Any, judge: Judge, cast: Sequence[str] | None) -> dict[str, Any]:
    """A shadow is judged under the picture's own light where the reference has it; everything else by the leaves."""
    own = judge == "shadow" and state.light.kind in ("lambert", "gouraud")
    # what is judged for its shadow or its matter has the sky's light of its own, where the reference has that
    shared = judge == "share" or (judge != "combination" and state.sky.kind == "ambient")
    sky = {} if shared else {"sky": "hemisphere"}
    falling = FOREST_SHADOWS if cast is None and judge != "matter" else tuple(cast or ())
    left_out = {kind: False for kind in FOREST_SHADOWS if kind not in falling}
    return {"light": state.light.kind if own else "leaf", **sky, **left_out}


def _in_two(part: Callable[[np.ndarray, int, Progress], Any], positions: np.ndarray, progress: Progress) -> Arrays:
    """A reference picture in two parts: the pixels' centres first, whose picture alone is what one sample a pixel
    shows.

    Args:
        part: renders some of the positions by a seed that differs by a number; or that number's jitter would repeat.
    """
    share = 1 / len(positions)
    first = part(positions[:1], 0, lambda done, words: progress(done * share, words))
    linear, error, seconds = first.radiance, first.standard_error, first.seconds
    regions = getattr(first, "regions", None)
    if len(positions) > 1:
        rest = part(positions[1:], 1, lambda done, words: progress(share + done * (1 - share), words))
        linear = share * first.radiance + (1 - share) * rest.radiance
        error = np.hypot(share * first.standard_error, (1 - share) * rest.standard_error)
        seconds = first.seconds + rest.seconds
        regions = None if regions is None else share * regions + (1 - share) * rest.regions
    mean = float(linear[..., :3].mean())
    made = {
        "linear": linear,
        "once": first.radiance,
        "standard_error": np.array(float(np.sqrt(np.mean(error**2))) / mean if mean > 0 else 0.0),
        "seconds": np.array(seconds),
    }
    return made if regions is None else {**made, "regions": regions.astype(np.float32)}


def _forest(
    world: Mapping[str, Any], looking: Any, positions: np.ndarray, options: Mapping[str, Any], progress: Progress
) -> Arrays:
    """March the forest."""
    from renderer.reference.forest import Options, render
    from renderer.reference.forest_world import ForestWorld

    forest = ForestWorld(**world)
    return _in_two(
        lambda places, seed, tell: render(forest, looking, places, Options(**options, seed=1 + seed), tell),
        positions,
        progress,
    )


def _clouds_options(state: Any, judge: Judge, cast: Sequence[str] | None) -> dict[str, Any]:
    """Clouds have one truth, whatever is judged."""
    return {}


def _clouds(
    world: Mapping[str, Any], looking: Any, positions: np.ndarray, options: Mapping[str, Any], progress: Progress
) -> Arrays:
    """Trace the clouds."""
    from renderer.reference.clouds import Options, render
    from renderer.reference.clouds_world import CloudsWorld

    clouds = CloudsWorld(**world)
    return _in_two(
        lambda places, seed, tell: render(clouds, looking, places, Options(**options, seed=1 + seed), tell),
        positions,
        progress,
    )


def _shells_options(state: Any, judge: Judge, cast: Sequence[str] | None) -> dict[str, Any]:
    """The light is a part of the shells' world: what shines by itself, or scatters on, is judged by what does."""
    own = state.light.kind in ("unlit", "scattering")
    return {
        "light": state.light.kind if own else "lambert",
        "level": float(getattr(state.light, "level", 1.0)),
        "asymmetry": float(getattr(state.light, "asymmetry", 0.0)),
        "shadows": judge != "matter" and cast is None,
    }


def _shells(
    world: Mapping[str, Any], looking: Any, positions: np.ndarray, options: Mapping[str, Any], progress: Progress
) -> Arrays:
    """Follow rays through the shell."""
    from renderer.reference.shells import Options, render
    from renderer.reference.shells_world import ShellsWorld, Surface

    opaque = ("base", "things")
    plain = {name: value for name, value in world.items() if name not in opaque} | dict(options)
    surfaces = tuple(Surface(**world[name]) for name in opaque if world[name] is not None)
    shells = ShellsWorld(**plain, surfaces=surfaces)
    return _in_two(
        lambda places, seed, tell: render(shells, looking, places, Options(seed=1 + seed), tell), positions, progress
    )


def _directional_options(state: Any, judge: Judge, cast: Sequence[str] | None) -> dict[str, Any]:
    """The light is the world's own; only whether the subject shadows itself is chosen."""
    return {"shadows": judge != "matter" and cast is None}


def _directional(
    world: Mapping[str, Any], looking: Any, positions: np.ndarray, options: Mapping[str, Any], progress: Progress
) -> Arrays:
    """Cast rays on the subject's own mesh."""
    from renderer.reference.directional import Options, render
    from renderer.reference.directional_world import DirectionalWorld, Lamp, part_of

    plain = {name: value for name, value in world.items() if name != "light"} | dict(options)
    parts, lamp = (world["light"].get(name) for name in ("parts", "lamp"))
    subject = DirectionalWorld(
        **plain, parts=tuple(part_of(each) for each in parts), lamp=None if lamp is None else Lamp(**lamp)
    )
    strata = max(2, 2 * round(math.sqrt(SKY_RAYS / len(positions)) / 2))
    return _in_two(
        lambda places, seed, tell: render(subject, looking, places, Options(strata, 1 + seed), tell),
        positions,
        progress,
    )


OPTIONS: dict[str, Callable[[Any, Judge, Sequence[str] | None], dict[str, Any]]] = {
    "forest": _forest_options,
    "clouds": _clouds_options,
    "shells": _shells_options,
    "directional": _directional_options,
}
"""Options of each phenomenon's reference."""

RENDER: dict[str, Callable[..., Arrays]] = {
    "forest": _forest,
    "clouds": _clouds,
    "shells": _shells,
    "directional": _directional,
}
"""How each phenomenon's world becomes a reference picture."""
