"""One OpenGL thread for the clouds' tests, functions evaluated among their techniques, shaders that can be spoiled."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from renderer.clouds.technique import CloudsTechnique
from renderer.core.baking import bake_now
from renderer.core.cache import Cache
from renderer.core.params import defines, uniform_declarations, uniforms
from renderer.core.registry import glsl_file
from renderer.core.technique import Arrays, Bake
from renderer.gl.context import GL
from renderer.gl.probe import probe
from renderer.gl.thread import GLThread

Ask = Callable[..., np.ndarray]
Baked = Callable[[Bake], Arrays]
Spoil = Callable[[str, str, str], AbstractContextManager[None]]


@pytest.fixture(scope="session")
def thread() -> Iterator[GLThread]:
    """A running OpenGL thread, closed without a leak after the clouds' tests."""
    with GLThread("clouds-tests") as running:
        yield running


@pytest.fixture(scope="session")
def baked() -> Baked:
    """The arrays of a bake, from the tests' cache or computed here."""
    cache = Cache()
    return lambda bake: bake_now(bake, cache)


@pytest.fixture(scope="session")
def ask(thread: GLThread, baked: Baked) -> Ask:
    """Evaluates GLSL among the techniques of some slots: `ask({slot: technique}, body, inputs, outputs)`."""
    return lambda *args, **keywords: thread.call(_asked, baked, *args, **keywords)


def _asked(
    gl: GL,
    baked: Baked,
    techniques: Mapping[str, CloudsTechnique],
    body: str,
    inputs: Mapping[str, np.ndarray],
    outputs: int = 3,
    *,
    files: Sequence[str] = (),
    textures: Mapping[str, np.ndarray] | None = None,
    values: Mapping[str, Any] | None = None,
    declarations: str = "",
    pictures: Mapping[str, np.ndarray] | None = None,
) -> np.ndarray:
    """Evaluate GLSL for N inputs.

    Args:
        techniques: by slot, in the order in which their files come; what they need is baked.
        files: more files, before the techniques'.
        textures: in the place of those of the techniques, by their full names.
        values: more uniforms. pictures: more samplers, repeated. declarations: of those.
    """
    state = SimpleNamespace(**techniques)
    arrays: dict[str, Arrays] = {}
    text, given, macros = [declarations], dict(values or {}), {}
    held = {
        name: gl.texture2d(np.asarray(array, np.float32), wrap="repeat") for name, array in (pictures or {}).items()
    }
    for technique in techniques.values():
        for bake in technique.bakes(state):
            arrays[bake.name] = baked(bake)
    shaders = list(files)
    for slot, technique in techniques.items():
        kept = {f"{slot}_{name}": array for name, array in technique.kept_textures(state, arrays).items()}
        held |= {name: _texture(gl, (textures or {}).get(name, array)) for name, array in kept.items()}
        text += [uniform_declarations(type(technique), slot), *technique.extra_declarations]
        text += [f"uniform {kind} {slot}_{name};" for name, kind in technique.textures.items()]
        given |= uniforms(technique, slot) | technique.constants(state, arrays)
        macros |= defines(technique, slot)
        shaders += [*technique.includes, glsl_file("clouds", slot, technique.kind)]
    try:
        return probe(
            gl,
            shaders,
            body,
            inputs,
            outputs,
            uniforms=given,
            textures=held,
            declarations="\n".join(text),
            defines=macros,
        )
    finally:
        for texture in held.values():
            texture.release()


def _texture(gl: GL, array: np.ndarray) -> Any:
    """A picture (H, W, C) or a volume (K, J, I, C) in float32."""
    made = gl.texture3d if array.ndim == 4 else gl.texture2d
    return made(np.asarray(array, np.float32))
