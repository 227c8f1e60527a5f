"""What light makes of a pattern from which a species map chooses: of all its species mixed, and of each alone.

At a place either one species stands or all do, thinned to a closed stand. What is found of the canopy is therefore
found for each of these *sections*, as if nothing else were planted, and a place reads its own.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from renderer.core.technique import Arrays
from renderer.forest.pattern_mips import coarser_opacity
from renderer.forest.planting import BAND_RANKS, RANKS, mixed_share

Tell = Callable[[float], None]


def sections(anchor: np.ndarray, bands: np.ndarray) -> list[np.ndarray]:
    """Whether each voxel's tree stands where all species are mixed, and where each stands alone: masks like `anchor`.

    Args:
        anchor: uint8 (..., 4). bands: of the planted species, ascending.
    """
    band, rank = np.divmod(anchor[..., 3] % RANKS, BAND_RANKS)
    return [rank < BAND_RANKS * mixed_share(len(bands)), *(band == one for one in bands)]


def opacities(pattern: Arrays, level: int = 0) -> list[np.ndarray]:
    """Opacity (K, J, I) uint8 of each section of a pattern at level 0 or 1; without a species map, of the only one."""
    if "bands" not in pattern:
        return [np.asarray(pattern["colour" if level == 0 else f"colour_{level}"])[..., 3]]
    alpha = np.asarray(pattern["colour"])[..., 3]
    made = [np.where(stand, alpha, np.uint8(0)) for stand in sections(np.asarray(pattern["anchor"]), pattern["bands"])]
    for _ in range(level):
        made = [coarser_opacity(one) for one in made]
    return made


def each_section(given: list[np.ndarray], found: Callable[[np.ndarray, Tell], np.ndarray], tell: Tell) -> np.ndarray:
    """What is found of each opacity, one after the other along the first axis.

    Args:
        given: of the sections. found: told the share done through its second argument. tell: told it of all.
    """
    made = []
    for number, one in enumerate(given):
        made.append(found(one, lambda share, done=number: tell((done + share) / len(given))))  # type: ignore[misc]
    return made[0] if len(made) == 1 else np.concatenate(made)


def of_owner(
    anchor: np.ndarray, bands: np.ndarray | None, found: Callable[[np.ndarray, Tell], np.ndarray], tell: Tell
) -> np.ndarray:
    """A quantity of the voxels, each found where only its own species stands; of air that belongs to none, the first's.

    Args:
        anchor: uint8 (K, J, I, 4). bands: of the planted species; none, where they always stand together.
        found: what (K, J, I) is found where only the voxels of a mask are left.
    """
    if bands is None:
        return found(np.ones(anchor.shape[:-1], bool), tell)
    result = np.empty(0)
    for number, mask in enumerate(sections(anchor, bands)[1:]):
        part = found(mask, lambda share, done=number: tell((done + share) / len(bands)))  # type: ignore[misc]
        result = np.where(mask, part, result) if number else part
    return result
