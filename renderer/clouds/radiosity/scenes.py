"""The four scenes of Belcour's annex A.2, bounded by the compute square of side 32H."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from renderer.clouds.radiosity.bases import HALF

GROUND, CLOUD, SNOW = 0.3, 0.9, 0.8
"""Albedos of ground and cloud as in section 5.1.3, and that of the ring's mountains, for which A.2 prints none."""


@dataclass(frozen=True)
class ValidationScene:
    """One scene; the cloud starts with radiosity 1 where it is, the ground with 0.

    Attributes:
        name, title: of it.
        nodes: heights of the corners of N x N cells over the compute square, in heights of the base, (N + 1, N + 1).
        albedo, reflectance, cloud: ground's albedo, cloud's reflectance and first radiosity by cell, (N, N).
    """

    name: str
    title: str
    nodes: np.ndarray
    albedo: np.ndarray
    reflectance: np.ndarray
    cloud: np.ndarray


def validation_scenes(n: int = 128) -> tuple[ValidationScene, ...]:
    """The four, on `n` x `n` cells."""
    corners = np.hypot(*np.meshgrid(*[np.linspace(-HALF, HALF, n + 1)] * 2))
    middles = (np.arange(n) + 0.5) * (2 * HALF / n) - HALF
    x, y = middles[None, :], middles[:, None]
    far, wide = np.hypot(x, y), np.maximum(np.abs(x), np.abs(y))
    level, one = np.zeros_like(corners), np.ones((n, n))
    square = (wide < 8).astype(np.float64)
    cone = 0.6 * np.maximum(0, 1 - corners / 4)
    ring = 0.6 * np.maximum(0, 1 - np.abs(corners - 6) / 2)
    snow = np.where(np.abs(far - 6) < 2, SNOW, GROUND)
    return (
        ValidationScene("uniform", "uniform cloud over level ground", level, GROUND * one, CLOUD * one, one),
        ValidationScene(
            "square", "square cloud of side 16H over level ground", level, GROUND * one, CLOUD * square, square
        ),
        ValidationScene(
            "cone", "uniform cloud over a cone 0.6H high of radius 4H", cone, GROUND * one, CLOUD * one, one
        ),
        ValidationScene(
            "ring", "uniform cloud over bright mountains 0.6H high, 6H around the middle", ring, snow, CLOUD * one, one
        ),
    )
