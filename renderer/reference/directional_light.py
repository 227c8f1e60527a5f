"""What a place of the subject sends to the eye, float64: the models' formulas, with exact shadows."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from renderer.reference.directional_brdf import reflected
from renderer.reference.directional_mesh import Hits, Subject, frames
from renderer.reference.directional_surroundings import Picture
from renderer.reference.directional_world import DirectionalWorld, Floats, Measured, Phong, Surroundings


class Shading:
    """Light of a world on its subject.

    Args:
        world: the world. subject: its triangles.
        side: square root of the rays that look for the open part of a hemisphere.
    """

    def __init__(self, world: DirectionalWorld, subject: Subject, side: int) -> None:
        self.world, self.subject, self.side = world, subject, side
        self.pictures: Mapping[int, Picture] = {
            id(part): Picture(np.asarray(part.image), part.rotation)
            for _, part in world.parts
            if isinstance(part, Surroundings)
        }
        self.gathers = any(
            weight * (part.diffuse if isinstance(part, Surroundings) else part.ambient) != 0
            for weight, part in world.parts
        )

    def radiance(self, hits: Hits, rng: np.random.Generator) -> tuple[Floats, Floats]:
        """(M, 3) towards the eye, W m-2 sr-1, and the variance of its mean over the channels (M,)."""
        world, count = self.world, len(hits.place)
        openness, variance = np.ones(count), np.zeros(count)
        if self.gathers and world.shadows:
            openness, variance = self.subject.openness(hits, self.side, rng)
        sun = np.broadcast_to(np.asarray(world.sun, np.float64), (count, 3))
        sunlit = self._free(hits, sun)[:, None] * np.asarray(world.e_sun)
        found, gathered = np.zeros((count, 3)), np.zeros((count, 3))
        lamp, lamplit = self._lamp(hits)
        for weight, part in world.parts:
            if not isinstance(part, Surroundings):
                found += weight * _sent(part, hits, sun) * sunlit
                if world.lamp is not None:
                    found += weight * _sent(part, hits, lamp) * lamplit
                gathered += weight * part.ambient * self._sky(hits)
            else:
                picture = self.pictures[id(part)]
                if part.diffuse:
                    gathered += weight * part.diffuse * hits.colour / math.pi * picture.irradiance(hits.normal)
                if part.specular:
                    mirrored = mirror(hits.to_eye, hits.normal)
                    found += weight * part.specular * picture.radiance(mirrored) * self._free(hits, mirrored)[:, None]
        return found + gathered * openness[:, None], variance * gathered.mean(axis=1) ** 2

    def _sky(self, hits: Hits) -> Floats:
        """What an open place sends of an even sky: the part of the upper dome that its plane sees."""
        share = (1 + hits.normal[:, 2:]) / 2
        return np.asarray(hits.colour / math.pi * np.asarray(self.world.e_sky) * share)

    def _lamp(self, hits: Hits) -> tuple[Floats, Floats]:
        """Directions to the lamp (M, 3) and its irradiance facing it (M, 3); nothing where there is none."""
        lamp = self.world.lamp
        if lamp is None:
            return hits.normal, np.zeros_like(hits.normal)
        away = np.asarray(lamp.place, np.float64) - hits.place
        distance = np.maximum(np.linalg.norm(away, axis=1), 1e-12)
        towards = away / distance[:, None]
        lit = self._free(hits, towards, distance)[:, None]
        return towards, lit * np.asarray(lamp.intensity) / distance[:, None] ** 2

    def _free(self, hits: Hits, towards: Floats, reach: Floats | None = None) -> Floats:
        """1 where light comes from a direction, 0 below the horizon or behind the subject, (M,)."""
        free = np.einsum("md,md->m", hits.normal, towards) > 0
        if self.world.shadows and free.any():
            within = None if reach is None else reach[free]
            free[free] = ~self.subject.blocked(hits.start[free], towards[free], within)
        return free.astype(np.float64)


def mirror(directions: Floats, normals: Floats) -> Floats:
    """Directions (M, 3) mirrored about normals."""
    return 2 * np.einsum("md,md->m", directions, normals)[:, None] * normals - directions


def _sent(part: Phong | Measured, hits: Hits, towards: Floats) -> Floats:
    return phong(part, hits, towards) if isinstance(part, Phong) else _measured(part, hits, towards)


def phong(part: Phong, hits: Hits, towards: Floats) -> Floats:
    """Share (M, 3) of the irradiance facing a light that is sent to the eye, 1/sr, the light's cosine in it."""
    cosine = np.maximum(np.einsum("md,md->m", hits.normal, towards), 0)[:, None]
    along = np.maximum(np.einsum("md,md->m", mirror(towards, hits.normal), hits.to_eye), 0)[:, None]
    lobe = (part.exponent + 2) / (2 * math.pi) * along**part.exponent
    return np.asarray((part.diffuse * hits.colour / math.pi + part.specular * lobe) * cosine)


def _measured(part: Measured, hits: Hits, towards: Floats) -> Floats:
    """The same of a measured material, in the frame of each normal."""
    tangent, bitangent = frames(hits.normal)
    axes = np.stack([tangent, bitangent, hits.normal], axis=1)
    eye, light = (np.einsum("mad,md->ma", axes, each) for each in (hits.to_eye, towards))
    return reflected(part, eye, light) * np.maximum(light[:, 2:], 0)
