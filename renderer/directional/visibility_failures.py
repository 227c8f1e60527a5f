"""Where textures of visibility fail, as numbers: parts thinner than a texel, and normals that look away."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from renderer.core.technique import Arrays
from renderer.directional.casting import NONE, Caster, face_frame, face_middles
from renderer.directional.hemisphere import hemisphere_of
from renderer.directional.visibility import FACES, layer

FINER = 8
"""Rays along each side of a texel that tell what stands in it."""

SAMPLE = 12
"""Directions of each face that a share is taken over, evenly among all."""


def missed_share(
    subject: Arrays, cloud: Arrays, texels: int, directions: int = 129, faces: Sequence[int] = range(FACES)
) -> float:
    """Share of what a face could see of a subject that stands in texels whose own ray meets nothing: 0 to 1.

    A thin part is drawn where a texel's middle meets it, and is gone between. The texels' own rays are among those that
    tell what there is.

    Args:
        subject, cloud: as baked. texels: d. directions: of a face, some of which are looked along.
        faces: that look.
    """
    caster = Caster(subject, cloud)
    all_of, lost = 0, 0
    for face in faces:
        ways = hemisphere_of(directions).directions() @ face_frame(face)
        finer = face_middles(caster.box, face, texels * FINER)
        middles = face_middles(caster.box, face, texels)
        for number in _sample(directions):
            met = caster.points(finer, -ways[number]) != NONE
            held = met.reshape(texels, FINER, texels, FINER).sum(axis=(1, 3))
            own = (caster.points(middles, -ways[number]) != NONE).reshape(texels, texels)
            all_of += int(held.sum())
            lost += int(held[~own].sum())
    return lost / max(all_of, 1)


def turned_share(cloud: Arrays, visibility: Arrays) -> float:
    """Share of the points that texels see whose normal looks away from the eye, as on the back of an open mesh: 0 to 1.

    Such a point is shaded as if lit from inside. Two-sided subjects have points with normals of their own behind.

    Args:
        cloud, visibility: as baked.
    """
    normal = cloud["normal"][visibility["used"]]
    directions = int(visibility["directions"])
    all_of, turned = 0, 0
    for face in range(FACES):
        ways = hemisphere_of(directions).directions() @ face_frame(face)
        for number in _sample(directions):
            points = layer(visibility, face, number)
            seen = normal[points[points != NONE]]
            all_of += len(seen)
            turned += int((seen @ ways[number] < LEVEL).sum())
    return turned / max(all_of, 1)


LEVEL = -0.35
"""Cosine of 110 degrees: a smooth normal may lean a little beyond the edge of what is seen, where its face does not."""


def _sample(directions: int) -> np.ndarray:
    return np.unique(np.linspace(0, directions - 1, SAMPLE).astype(int))
