"""Maps of first light for the bounce techniques, and what their shaders make of what they solved."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from renderer.clouds.basis.object import ObjectBasis
from renderer.clouds.radiosity.bases import CELL, GRID
from renderer.clouds.radiosity.maps import BounceMaps
from renderer.clouds.radiosity.technique import BasisTechnique, BounceTechnique, Solved
from renderer.core.params import defines, uniform_declarations, uniforms
from renderer.core.registry import glsl_file
from renderer.gl.context import GL
from renderer.gl.probe import probe
from renderer.gl.thread import GLThread

HEIGHT = 2500.0
Shown = Callable[..., tuple[np.ndarray, np.ndarray]]


def maps(**given: Any) -> BounceMaps:
    """Even maps, but for what is given."""
    one = np.ones((GRID, GRID, 3))
    default = {
        "elevation": np.zeros((GRID, GRID)),
        "albedo": 0.3 * one,
        "reflectance": 0.6 * one,
        "ground": 200 * one,
        "cloud": 0 * one,
    }
    return BounceMaps(CELL * HEIGHT, HEIGHT, **{**default, **given})


def uneven(seed: int = 1) -> BounceMaps:
    """Maps in which every field varies smoothly, each band its own way."""
    rng = np.random.default_rng(seed)
    x, y = np.meshgrid(*[np.linspace(0, 2 * np.pi, GRID)] * 2)

    def field(low: float, high: float) -> np.ndarray:
        a, b, c = rng.uniform(0, 2 * np.pi, (3, 3))
        wave = 0.5 + 0.25 * (np.sin(x[..., None] + a) + np.sin(2 * y[..., None] + b) * np.cos(x[..., None] + c))
        return low + (high - low) * np.clip(wave, 0, 1)

    return maps(albedo=field(0.1, 0.7), reflectance=field(0.0, 0.8), ground=field(50, 800), cloud=field(0, 30))


@pytest.fixture(scope="session")
def shown(thread: GLThread) -> Shown:
    """Ground's and cloud's added light as a technique's shader gives it: `shown(bounce, basis, solved, places)`."""

    def ask(
        bounce: BounceTechnique,
        basis: BasisTechnique | None,
        solved: Solved,
        places: np.ndarray,
        here: tuple[float, float, float] = (200.0, 0.3, 0.6),
    ) -> tuple[np.ndarray, np.ndarray]:
        return thread.call(_shown, bounce, basis or ObjectBasis(), solved, places, here)

    return ask


def _shown(
    gl: GL,
    bounce: BounceTechnique,
    basis: BasisTechnique,
    solved: Solved,
    places: np.ndarray,
    here: tuple[float, float, float],
) -> tuple[np.ndarray, np.ndarray]:
    text, pictures, values, macros = [], {}, dict(bounce.numbers(solved.maps.half, solved.maps.centre)), {}
    for slot, technique in (("basis", basis), ("bounce", bounce)):
        text += [uniform_declarations(type(technique), slot), *technique.extra_declarations]
        text += [f"uniform {kind} {slot}_{name};" for name, kind in technique.textures.items()]
        values |= uniforms(technique, slot)
        macros |= defines(technique, slot)
        for name, array in technique.pictures(solved).items():
            made = gl.texture3d if array.ndim == 4 else gl.texture2d
            pictures[f"{slot}_{name}"] = made(np.asarray(array, np.float32))
    files = [*bounce.includes, glsl_file("clouds", "basis", basis.kind), glsl_file("clouds", "bounce", bounce.kind)]
    body = "BounceHere here = BounceHere(vec3({:f}), vec3({:f}), vec3({:f}));".format(*here)
    used = {name for name in values if name in "\n".join(text)}
    try:
        found = [
            probe(
                gl,
                files,
                f"{body} result.rgb = bounce_{side}(place, here);",
                {"place": places},
                3,
                uniforms={name: values[name] for name in used},
                textures=pictures,
                declarations="\n".join(text),
                defines=macros,
            )
            for side in ("ground", "cloud")
        ]
    finally:
        for texture in pictures.values():
            texture.release()
    return found[0], found[1]


def middles(inner: float = 0.69) -> tuple[np.ndarray, np.ndarray]:
    """Places of cells' middles inside the fade, (P, 2) in m, and their rows and columns."""
    along = (np.arange(GRID) + 0.5) * CELL * HEIGHT - GRID * CELL * HEIGHT / 2
    x, y = np.meshgrid(along, along)
    inside = np.maximum(np.abs(x), np.abs(y)) < inner * GRID * CELL * HEIGHT / 2
    rows, columns = np.nonzero(inside)
    return np.stack([x[inside], y[inside]], axis=-1), np.stack([rows, columns])
