"""A small dragon on its four feet: bones with flesh about them, skin between the fingers of its wings, and scales."""

from __future__ import annotations

from itertools import pairwise
from typing import Literal

import numpy as np
from scipy.spatial import cKDTree

from renderer.core.params import Model, param
from renderer.directional.subject.solid import Solid
from renderer.directional.subject.surface_nets import surface_nets
from renderer.directional.subject.waves import waves
from renderer.world.mesh_normals import vertex_normals

SPINE = np.array([  # x, y, z, radius from the tail's tip to the snout
    (-0.98, 0.62, 0.03, 0.012), (-1.08, 0.40, 0.035, 0.02), (-1.06, 0.17, 0.05, 0.034), (-0.93, 0.0, 0.09, 0.052),
    (-0.72, -0.06, 0.2, 0.082), (-0.5, -0.03, 0.36, 0.12), (-0.27, 0.0, 0.46, 0.16), (0.02, 0.0, 0.49, 0.165),
    (0.26, 0.0, 0.55, 0.165), (0.44, 0.0, 0.68, 0.125), (0.53, 0.0, 0.86, 0.09), (0.52, 0.0, 1.02, 0.075),
    (0.58, 0.0, 1.16, 0.07), (0.7, 0.0, 1.22, 0.085), (0.83, 0.0, 1.19, 0.062), (0.97, 0.0, 1.13, 0.036),
])
LIMBS = (  # the left ones; x, y, z, radius
    np.array([(0.3, 0.1, 0.48, 0.1), (0.36, 0.2, 0.3, 0.062), (0.27, 0.21, 0.15, 0.042), (0.36, 0.22, 0.035, 0.04),
              (0.47, 0.24, 0.02, 0.022)]),
    np.array([(-0.3, 0.1, 0.42, 0.13), (-0.16, 0.22, 0.28, 0.088), (-0.36, 0.22, 0.14, 0.046),
              (-0.27, 0.24, 0.035, 0.044), (-0.13, 0.26, 0.02, 0.023)]),
)
HORNS = (
    np.array([(0.66, 0.045, 1.28, 0.032), (0.52, 0.085, 1.37, 0.02), (0.38, 0.11, 1.38, 0.006)]),
    np.array([(0.68, 0.07, 1.2, 0.024), (0.58, 0.13, 1.2, 0.006)]),
)
JAW = np.array([(0.7, 0.0, 1.14, 0.05), (0.82, 0.0, 1.09, 0.032), (0.92, 0.0, 1.03, 0.016)])
SHOULDER, ELBOW, WRIST = (np.array(p) for p in ((0.2, 0.1, 0.66), (0.02, 0.36, 1.0), (0.2, 0.62, 1.3)))
FINGERS = np.array([(-0.22, 1.1, 1.34), (-0.5, 0.98, 0.98), (-0.55, 0.68, 0.72), (-0.42, 0.3, 0.6), (-0.25, 0.1, 0.6)])
"""Tips of the left wing's bones, the last where its skin meets the back."""

RAISED = np.array([-0.5, 0.0, 0.87])
"""The way that thorns of the crest stand, where the spine lets them."""

EYE = np.array([0.775, 0.066, 1.235])

SKIN = 0.009
"""Half as thick as the wings' skin [m]."""

BLEND = 0.045
"""Over which flesh of neighbouring bones flows together [m]."""

CELL = 0.0085
LOW, HIGH = np.array([-1.2, -1.2, -0.06]), np.array([1.1, 1.2, 1.5])

HIDE, BACK, BELLY, WING, HORN, AMBER = (np.array(c) for c in (
    (0.10, 0.26, 0.12), (0.04, 0.12, 0.08), (0.52, 0.46, 0.26), (0.42, 0.13, 0.06), (0.42, 0.37, 0.28),
    (0.7, 0.4, 0.05)))
"""Linear reflectance."""


class Dragon(Model):
    """A small dragon."""

    kind: Literal["dragon"] = "dragon"
    size: float = param(2.0, label="Size", help="Of its longest side.", unit="m", cost="bake", gt=0, le=1000)
    scales: float = param(
        0.03, label="Scales", help="How wide they are, in the dragon's own length of about 2.", unit="ratio",
        cost="bake", ge=0.02, le=0.1,
    )

    def solid(self) -> Solid:
        """Its triangles."""
        vertices, faces = surface_nets(_distance, LOW, HIGH, CELL)
        flesh, horn, wing = (part(vertices[:, None])[:, 0] for part in (_flesh, _horns, _wings))
        soft = np.clip((np.minimum(horn, wing) - flesh) / 0.02, 0, 1)
        normal = vertex_normals(vertices, faces)
        bump, seed = _scales(vertices, self.scales)
        vertices = vertices + normal * (0.3 * self.scales * (bump - 0.6) * soft)[:, None]
        up = np.clip(normal[:, 2] * 1.3 + waves(vertices, 0.35, 5) * 0.25, -1, 1)[:, None]
        hide = HIDE + (BACK - HIDE) * np.clip(up, 0, 1) + (BELLY - HIDE) * np.clip(-1.4 * up - 0.2, 0, 1)
        hide = hide * (0.7 + 0.45 * bump)[:, None] * (0.85 + 0.3 * seed)[:, None]
        veins = 1 + 0.25 * waves(vertices, 0.2, 6)[:, None]
        colour = np.where((wing < np.minimum(flesh, horn))[:, None], WING * veins, hide)
        colour = np.where((horn < np.minimum(flesh, wing))[:, None], HORN, colour)
        eye = np.linalg.norm(np.abs(vertices * [0, 1, 0]) + vertices * [1, 0, 1] - EYE, axis=1)
        colour = np.where((eye < 0.026)[:, None], np.where((eye < 0.013)[:, None], 0.01, AMBER), colour)
        return Solid(vertices, faces, colour[faces].mean(axis=1))


def _scales(vertices: np.ndarray, width: float) -> tuple[np.ndarray, np.ndarray]:
    """How high each vertex stands on its scale, 1 in the middle and 0 between scales, and a number in [0, 1] of it."""
    cells = np.floor(vertices / width).astype(np.int64)
    _, first = np.unique(cells, axis=0, return_index=True)
    seeds = vertices[np.sort(first)]
    # Of two seeds that stand closer than a scale's width the later one goes.
    pairs = cKDTree(seeds).query_pairs(0.75 * width, output_type="ndarray")
    keep = np.ones(len(seeds), bool)
    for a, b in pairs[np.lexsort(pairs.T[::-1])]:
        if keep[a]:
            keep[b] = False
    away, nearest = cKDTree(seeds[keep]).query(vertices, k=2)
    gap = np.clip((away[:, 1] - away[:, 0]) / (0.6 * width), 0, 1)
    return np.sqrt(gap), (nearest[:, 0] * 0.6180339887) % 1


def _distance(place: np.ndarray) -> np.ndarray:
    return _smooth(_smooth(_flesh(place), _wings(place), 0.015), _horns(place), 0.01)


def _smooth(a: np.ndarray, b: np.ndarray, width: float) -> np.ndarray:
    """The smaller of two distances, rounded where they are alike (Quilez 2013, polynomial)."""
    share = np.clip(0.5 + 0.5 * (b - a) / width, 0, 1)
    return np.asarray(b + (a - b) * share - width * share * (1 - share))


def _bone(place: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Distance from a bone (x, y, z, radius) to (x, y, z, radius), a little short where it tapers."""
    a, b = a.astype(place.dtype), b.astype(place.dtype)
    way, off = b[:3] - a[:3], place - a[:3]
    t = np.clip(off @ way / (way @ way), 0, 1)
    away = off - t[..., None] * way
    return np.asarray(np.sqrt(np.einsum("...k,...k->...", away, away)) - (a[3] + (b[3] - a[3]) * t), place.dtype)


def _union(place: np.ndarray, bones: list[tuple[np.ndarray, np.ndarray]], width: float) -> np.ndarray:
    """Distance from bones joined smoothly; a block far from a bone does not ask for it."""
    middle = place.mean(axis=1)
    reach = np.linalg.norm(place - middle[:, None], axis=-1).max(axis=1) if len(place) else np.zeros(0)
    rough = np.stack([_bone(middle, a, b) for a, b in bones])
    nearest = rough.min(axis=0)
    total = np.full(place.shape[:2], 1e3, place.dtype)
    for (a, b), off in zip(bones, rough):
        asked = np.flatnonzero(off < nearest + 2 * reach + 2 * width)
        total[asked] = _smooth(total[asked], _bone(place[asked], a, b), width)
    return total


def _mirrored(chain: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    return [*pairwise(chain), *pairwise(chain * np.array([1, -1, 1, 1]))]


def _flesh(place: np.ndarray) -> np.ndarray:
    bones = list(pairwise(SPINE)) + list(pairwise(JAW))
    for limb in LIMBS:
        bones += _mirrored(limb)
    return _union(place, bones, BLEND)


def _horns(place: np.ndarray) -> np.ndarray:
    bones = [bone for horn in HORNS for bone in _mirrored(horn)]
    # A crest along the back: thorns that lean towards the tail.
    for share in np.linspace(2.2, 11.6, 24):
        low = int(share)
        x, y, z, radius = SPINE[low] + (SPINE[low + 1] - SPINE[low]) * (share - low)
        way = SPINE[low + 1][:3] - SPINE[low][:3]
        # Up and back: on the neck, which leans back at its foot, too.
        up = RAISED - way * (RAISED @ way) / (way @ way)
        up /= np.linalg.norm(up)
        foot = np.array([x, y, z]) + 0.85 * radius * up
        tip = foot + up * (0.05 + 0.35 * radius) - 0.05 * way / np.linalg.norm(way)
        bones.append((np.append(foot, 0.12 * radius + 0.012), np.append(tip, 0.004)))
    for limb in LIMBS:
        for side in (-0.035, 0.0, 0.035):
            toe = limb[-1][:3] + [0.0, side, 0.0]
            bones += _mirrored(np.stack([np.append(toe, 0.02), np.append(toe + [0.06, 0.3 * side, -0.012], 0.005)]))
    return _union(place, bones, 0.01)


def _wings(place: np.ndarray) -> np.ndarray:
    """Both wings at once, by the side that a place lies on."""
    left = place * np.array([1, 0, 1], place.dtype)
    left[..., 1] = np.abs(place[..., 1])
    bones = [(np.append(SHOULDER, 0.06), np.append(ELBOW, 0.036)), (np.append(ELBOW, 0.036), np.append(WRIST, 0.026))]
    bones += [(np.append(WRIST, 0.02), np.append(tip, 0.008)) for tip in FINGERS[:4]]
    total = _union(left, bones, 0.02)
    middle = left.mean(axis=1)
    reach = 2 * np.linalg.norm(left - middle[:, None], axis=-1).max(axis=1) + 0.1
    webs = [(WRIST, a, b, True) for a, b in pairwise(FINGERS)]
    for a, b, c, arc in [*webs, (ELBOW, FINGERS[-1], SHOULDER, False), (ELBOW, WRIST, FINGERS[-1], False)]:
        # A block beyond its own width from this skin is nearer to something else, or far from all.
        asked = np.flatnonzero(_triangle(middle, a, b, c) < reach) if left.shape[1] > 1 else slice(None)
        total[asked] = _smooth(total[asked], _web(left[asked], a, b, c, arc), 0.015)
    return total


def _web(place: np.ndarray, top: np.ndarray, a: np.ndarray, b: np.ndarray, arc: bool) -> np.ndarray:
    """Distance from skin in a triangle, cut out in an arc along its side from a to b where `arc` is set."""
    skin = _triangle(place, top, a, b) - place.dtype.type(SKIN)
    if not arc:
        return np.asarray(skin)
    middle, half = (a + b) / 2, float(np.linalg.norm(b - a)) / 2
    away = middle - top
    centre = middle + away / np.linalg.norm(away) * 0.9 * half
    radius = float(np.linalg.norm(a - centre))
    return np.maximum(skin, radius - np.linalg.norm(place - centre.astype(place.dtype), axis=-1))


def _triangle(place: np.ndarray, a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Distance from a triangle."""
    normal = np.cross(b - a, c - a)
    normal = (normal / np.linalg.norm(normal)).astype(place.dtype)
    a, b, c = (corner.astype(place.dtype) for corner in (a, b, c))
    best = np.full(place.shape[:-1], np.inf, place.dtype)
    inside = np.ones(place.shape[:-1], bool)
    for p, q in ((a, b), (b, c), (c, a)):
        way, off = q - p, place - p
        inside &= off @ np.cross(normal, way) >= 0
        t = np.clip(off @ way / (way @ way), 0, 1)
        off = off - t[..., None] * way
        best = np.minimum(best, np.einsum("...k,...k->...", off, off))
    return np.where(inside, np.abs((place - a) @ normal), np.sqrt(best))
