"""One OpenGL thread for the forest's tests, hand-made worlds to draw, and shaders that can be spoiled."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from typing import Any

import numpy as np
import pytest

from renderer import view
from renderer.core.params import uniform_declarations, uniforms
from renderer.core.technique import Arrays, BakedArrays
from renderer.forest import program
from renderer.forest.renderer import ForestRenderer
from renderer.forest.state import ForestState, Ground
from renderer.forest.technique import ForestTechnique
from renderer.gl.context import GL
from renderer.gl.probe import probe
from renderer.gl.program import AnyTexture
from renderer.gl.thread import GLThread
from renderer.picture import Picture
from tests.forest import worlds
from tests.forest.truth import Judge

Ask = Callable[..., np.ndarray]
Paint = Callable[..., Picture]
Spoil = Callable[[str, str, str], AbstractContextManager[None]]

@pytest.fixture(scope="session")
def thread() -> Iterator[GLThread]:
    """A running OpenGL thread, closed without a leak after the forest's tests."""
    with GLThread("forest-tests") as running:
        yield running


@pytest.fixture(scope="session")
def painter(thread: GLThread) -> view.Painter:
    """What draws on that thread."""
    return view.Painter(thread)


@pytest.fixture(scope="session")
def paint(thread: GLThread, painter: view.Painter) -> Paint:
    """Draws a state with hand-made bakes: `paint(state, baked, (width, height), samples)`."""

    def painted(state: ForestState, baked: Mapping[str, BakedArrays], size: tuple[int, int], samples: int) -> Picture:
        return view.paint(thread, painter, state, baked, size, samples)

    return painted


@pytest.fixture(scope="session")
def ask(thread: GLThread) -> Ask:
    """Evaluates GLSL of the forest in a world: see `_asked`."""
    drawers: list[ForestRenderer] = []
    return lambda *args, **keywords: thread.call(_asked, drawers, *args, **keywords)


def _asked(
    gl: GL,
    drawers: list[ForestRenderer],
    files: Sequence[str],
    body: str,
    inputs: Mapping[str, np.ndarray],
    outputs: int = 1,
    *,
    terrain: Arrays | None = None,
    pattern: Arrays | None = None,
    state: ForestState | None = None,
    techniques: Mapping[str, ForestTechnique] | None = None,
    textures: Mapping[str, np.ndarray] | None = None,
    values: Mapping[str, Any] | None = None,
    declarations: str = "",
    local: bool = False,
) -> np.ndarray:
    """Evaluate GLSL for N inputs among the world's samplers and uniforms.

    Args:
        drawers: empty at first; then the renderer whose textures and uniforms are asked.
        files: beside `forest/world.glsl`, which always comes first.
        terrain, pattern: bakes; level ground and an empty pattern by default.
        state: for sun, ground and seed. techniques: by slot, whose live parameters are declared and set.
        textures: of those techniques, by their full names. values: more uniforms. declarations: of those.
        local: whether trees are taller at one place than at another.
    """
    if not drawers:
        drawers.append(ForestRenderer(gl))
    state = state or worlds.state()
    baked = worlds.together(sky=worlds.sky(), terrain=terrain or worlds.ground(), pattern=pattern or worlds.uniform(0))
    made = {
        "scout": gl.texture2d(np.zeros((1, 1), np.float32)),
        **{name: _texture(gl, np.asarray(a)) for name, a in (textures or {}).items()},
    }
    # What the renderer itself gives the world's uniforms and samplers, whatever they are.
    held = drawers[0]._world_textures(state, baked)
    given: dict[str, Any] = {**drawers[0]._world(state, baked), "sun_irradiance": worlds.E_SUN,
                             "sky_irradiance": worlds.E_SKY, "pixel_angle": 0.0, "pixel_width": 0.0}
    for slot, technique in (techniques or {}).items():
        if any(f"{slot}_{name}" not in made for name in technique.textures):
            held |= drawers[0]._kept(slot, technique, state, baked)
    text = [program.WORLD_DECLARATIONS, uniform_declarations(Ground, "ground")]
    sections = 1 + int(terrain["sections"].max()) if terrain and "sections" in terrain else 0
    for slot, technique in (techniques or {}).items():
        text += [uniform_declarations(type(technique), slot), *technique.extra_declarations]
        text += [f"uniform {kind} {slot}_{name};" for name, kind in technique.textures.items()]
        given |= uniforms(technique, slot) | technique.constants()
    try:
        return probe(gl, ["forest/world.glsl", *files], body, inputs, outputs, uniforms=given | dict(values or {}),
                     textures=held | made, declarations="\n".join([*text, declarations]),
                     defines=program._limits((("LOCAL_CANOPY", int(local)), ("SPECIES_MAP", sections))))
    finally:
        for texture in made.values():
            texture.release()


def _texture(gl: GL, array: np.ndarray) -> AnyTexture:
    """A picture (H, W, ..) in float32, or bytes of a volume (K, J, I, C)."""
    if array.ndim == 4:
        return gl.texture3d(array, "linear", ("repeat", "repeat", "clamp"))
    return gl.texture2d(array.astype(np.float32), wrap="repeat")


@pytest.fixture(scope="session")
def judge(thread: GLThread, painter: view.Painter, pytestconfig: pytest.Config) -> Judge:
    """Holds techniques to the reference and to frozen pictures."""
    return Judge(thread, painter, pytestconfig.getoption("--regenerate"))
