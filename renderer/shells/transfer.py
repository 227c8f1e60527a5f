"""Light that is scattered on and on within a shell: what of it reaches a voxel, by where the sun stands.

Precomputed radiance transfer of a volume (Sloan, Kautz and Snyder 2002, "Precomputed radiance transfer for real-time
rendering in dynamic, low-frequency lighting environments"), of one block of the texture that lies level and repeats: a
voxel's light under a sun in direction s is a smooth function of s, of which four spherical harmonics are kept. They are
found backwards: a walk of light that starts in a voxel and leaves the shell in direction s tells what comes from there
(reciprocity). Walks that leave without a meeting are left out: the sun's own light is found exactly elsewhere.

What comes to a voxel is not alike from all sides: it keeps some of the sun's direction. Its mean cosine to that, mu
between where a walk began and where it left, stands for a lobe of Henyey and Greenstein's, which scattering widens once
more: the products of mean cosines. As if alike from all sides, light seen from the sun's side would be too bright: in
the shared volume by a twentieth of all of it, which errs by 0.074 against Mitsuba's picture, with lobes by 0.046.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from renderer.core.technique import Arrays
from renderer.shells.texture.block import extinction_of, texture_of
from renderer.shells.transfer_kernels import walks

TABLE = ("sky red", "sky green", "sky blue", "sky rise", "F0 red", "F0 green", "F0 blue", "", "F1 x", "F1 y", "F1 z",
         "G0", "G1 x", "G1 y", "G1 z", "")  # fmt: skip
"""Numbers of a voxel: the share of an even sky's radiance that reaches it, however often scattered, and the mean over
the same walks of how steeply they began upwards (grey); and of what is scattered at least once, means over the walks:
F0 of their weight, F1 of weight times where they left (grey), G0 and G1 of the same times mu."""


def bake_transfer(
    arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]
) -> Arrays:
    """The transfer of a texture's block.

    Args:
        arguments: `thickness` of the shell [m], `density`, factor on the extinction, `moment` (keywords of
            `texture_of`), `repeats`, `base` (its reflectance, or None where the shell is hollow), and of the technique
            `asymmetry`, `across` (voxels along the longest side) and `walks`.
        inputs: `texture`.

    Returns:
        `table` (4 K, J, I, 4) float16: four blocks of `TABLE`, one over the other.
    """
    texture = texture_of(inputs["texture"], arguments["thickness"], **arguments["moment"])
    extinction = extinction_of(texture.colour[..., 3], texture.reference_length) * arguments["density"]
    matter = np.concatenate([texture.colour[..., :3] * extinction[..., None], extinction[..., None]], axis=-1)
    matter = coarsened(matter.astype(np.float64), arguments["across"])
    sigma = np.ascontiguousarray(matter[..., 3])
    colour = np.ascontiguousarray(matter[..., :3] / np.maximum(sigma, 1e-12)[..., None])
    sides = np.array(texture.size) * arguments["thickness"] / texture.size[2]
    base = np.array(arguments["base"] if arguments["base"] is not None else (-1.0, -1.0, -1.0), float)
    found = np.zeros((*sigma.shape, len(TABLE)))
    for layer in range(len(sigma)):
        progress(layer / len(sigma), "following scattered light")
        walks(sigma, colour, sides, arguments["asymmetry"], arguments["repeats"], base, arguments["walks"], layer,
              layer + 1, found)  # fmt: skip
    return {"table": np.concatenate(np.split(found, 4, axis=-1)).astype(np.float16)}


def coarsened(block: np.ndarray, across: int) -> np.ndarray:
    """Means of a block (K, J, I, C) over whole voxels, so that no side has more than `across`."""
    for axis in range(3):
        length = block.shape[axis]
        step = math.ceil(length / across)
        edges = np.arange(0, length, step)
        sums = np.add.reduceat(block, edges, axis=axis)
        shape = [-1 if n == axis else 1 for n in range(4)]
        block = sums / np.diff([*edges, length]).reshape(shape)
    return block


def transferred(values: np.ndarray, sun: np.ndarray, cosine: Any, lobe: float) -> np.ndarray:
    """Scattered light that matter sends on to the eye, per unit of irradiance of the sun and of colour, (..., 3) 1/sr:
    the twin of shaders/shells/light/scattering.glsl.

    Args:
        values: (..., 16) of `TABLE`. sun: (3,) unit vector in the block's frame. cosine: of the scattering angle
            between sun and eye. lobe: of the phase function.
    """
    later = values[..., 4:7]
    grey = np.maximum(later.mean(axis=-1), 1e-9)
    whole = np.maximum(grey + 3 * values[..., 8:11] @ sun, 1e-3 * grey)
    kept = np.clip((values[..., 11] + 3 * values[..., 12:15] @ sun) / whole, -0.95, 0.95)
    found: np.ndarray = later * (whole / grey * phase(lobe * kept, cosine))[..., None]
    return found


def phase(lobe: Any, cosine: Any) -> Any:
    """Henyey and Greenstein's phase function, 1/sr (1941), of a mean cosine at the cosine of an angle."""
    return (1 - lobe**2) / (4 * math.pi * (1 + lobe**2 - 2 * lobe * cosine) ** 1.5)
