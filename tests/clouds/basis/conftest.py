"""Evaluates a basis' functions in the shader."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from renderer.clouds.radiosity.bases import GRID, Basis
from renderer.clouds.radiosity.technique import BasisTechnique, InBasis
from renderer.core.registry import glsl_file
from renderer.gl.context import GL
from renderer.gl.probe import probe
from renderer.gl.thread import GLThread

Evaluated = Callable[..., tuple[np.ndarray, np.ndarray]]


@pytest.fixture(scope="session")
def evaluated(thread: GLThread) -> Evaluated:
    """Light of both sides at places of the square, (P, 3) each: `evaluated(technique, basis, ground, cloud, at)`."""
    return lambda *arguments: thread.call(_evaluated, *arguments)


def _evaluated(
    gl: GL, technique: BasisTechnique, basis: Basis, ground: np.ndarray, cloud: np.ndarray, at: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    solved: Any = SimpleNamespace(ground=InBasis(basis, ground), cloud=InBasis(basis, cloud))
    made = {f"basis_{name}": gl.texture2d(array) for name, array in technique.pictures(solved).items()}
    try:
        found = [
            probe(
                gl,
                [glsl_file("clouds", "basis", technique.kind)],  # type: ignore[attr-defined]
                f"basis_{side}(at)",
                {"at": at},
                3,
                textures=made,
            )
            for side in ("ground", "cloud")
        ]
    finally:
        for texture in made.values():
            texture.release()
    return found[0], found[1]


def cell_middles() -> np.ndarray:
    """Middles of all cells, row by row, (GRID^2, 2), -1 to 1."""
    along = (np.arange(GRID) + 0.5) * 2 / GRID - 1
    x, y = np.meshgrid(along, along)
    return np.stack([x.ravel(), y.ravel()], axis=-1)
