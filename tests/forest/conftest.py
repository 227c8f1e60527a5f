"""One OpenGL thread for the forest's tests, hand-made worlds to draw, and shaders that can be spoiled."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from typing import Any

import numpy as np
import pytest

from renderer.core.params import uniform_declarations, uniforms
from renderer.core.technique import Arrays, BakedArrays
from renderer.forest import program
from renderer.forest.renderer import relief
from renderer.forest.state import ForestState, Ground
from renderer.forest.technique import ForestTechnique
from renderer.forest.textures import TILE_MAP, ground_textures, pattern_textures, tile_map
from renderer.forest.world_scale import CANOPY_HEIGHT, CELL, NODES, REACH, TILE_SIDE, VOXEL
from renderer.gl import source
from renderer.gl.context import GL
from renderer.gl.probe import probe
from renderer.gl.resident import Resident
from renderer.gl.thread import GLThread
from renderer.picture import Picture
from renderer.view import Painter
from renderer.world.sun import angles, direction
from tests.forest import worlds
from tests.forest.truth import Judge

Ask = Callable[..., np.ndarray]
Paint = Callable[..., Picture]
Spoil = Callable[[str, str, str], AbstractContextManager[None]]

LIMITS = {
    "ENTRY_STEPS": program.ENTRY_STEPS, "MARCH_STEPS": program.MARCH_STEPS, "LIGHT_EVENTS": program.LIGHT_EVENTS,
    "TILE_MAP": f"{TILE_MAP}.0", "SCOUT_BLOCK": f"{program.SCOUT_BLOCK}.0",
}


@pytest.fixture(scope="session")
def thread() -> Iterator[GLThread]:
    """A running OpenGL thread, closed without a leak after the forest's tests."""
    with GLThread("forest-tests") as running:
        yield running


@pytest.fixture(scope="session")
def paint(thread: GLThread) -> Paint:
    """Draws a state with hand-made bakes: `paint(state, baked, (width, height), samples)`."""
    painter = Painter(thread)

    def painted(state: ForestState, baked: Mapping[str, BakedArrays], size: tuple[int, int], samples: int) -> Picture:
        return thread.call(painter.picture, state, baked, size, samples)

    return painted


@pytest.fixture(scope="session")
def ask(thread: GLThread) -> Ask:
    """Evaluates GLSL of the forest in a world: see `_asked`."""
    residents: list[Resident] = []
    return lambda *args, **keywords: thread.call(_asked, residents, *args, **keywords)


def _asked(
    gl: GL,
    residents: list[Resident],
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
) -> np.ndarray:
    """Evaluate GLSL for N inputs among the world's samplers and uniforms.

    Args:
        residents: keeps the textures of the worlds that were asked last; empty at first.
        files: beside `forest/world.glsl`, which always comes first.
        terrain, pattern: bakes; level ground and an empty pattern by default.
        state: for sun, ground and seed. techniques: by slot, whose live parameters are declared and set.
        textures: of those techniques, by their full names. values: more uniforms. declarations: of those.
    """
    if not residents:
        residents.append(Resident(gl, 12))
    kept, held = residents[0], dict[str, Any]()
    state = state or worlds.state()
    terrain, pattern, seed = terrain or worlds.ground(), pattern or worlds.uniform(0), state.ground.map_seed
    steepness, top = relief(terrain["elevation"])
    for key, entry in worlds.together(terrain=terrain, pattern=pattern).items():
        make = ground_textures if key == "terrain" else pattern_textures
        held |= kept.get(entry.key, lambda e=entry, m=make: m(gl, e.arrays))  # type: ignore[misc]
    held |= kept.get(seed, lambda: {"tiles": gl.texture2d(tile_map(seed), "nearest", "repeat")})
    made = {
        "scout": gl.texture2d(np.zeros((1, 1), np.float32)),
        **{name: gl.texture2d(np.asarray(a, np.float32), wrap="repeat") for name, a in (textures or {}).items()},
    }
    text = [program.WORLD_DECLARATIONS, uniform_declarations(Ground, "ground")]
    given: dict[str, Any] = {
        "terrain_cell": CELL, "terrain_nodes": float(NODES), "terrain_steepness": steepness, "tile_side": TILE_SIDE,
        "voxel_size": VOXEL, "canopy_height": CANOPY_HEIGHT, "scene_top": top + CANOPY_HEIGHT, "scene_reach": REACH,
        "sun_direction": direction(state.sun), "sun_elevation": angles(state.sun)[1], "sun_irradiance": worlds.E_SUN,
        "sky_irradiance": (1.0, 2.0, 4.0), **uniforms(state.ground, "ground"),
    }
    for slot, technique in (techniques or {}).items():
        text += [uniform_declarations(type(technique), slot), *technique.extra_declarations]
        text += [f"uniform {kind} {slot}_{name};" for name, kind in technique.textures.items()]
        given |= uniforms(technique, slot) | technique.constants()
    try:
        return probe(gl, ["forest/world.glsl", *files], body, inputs, outputs, uniforms=given | dict(values or {}),
                     textures=held | made, declarations="\n".join([*text, declarations]), defines=LIMITS)
    finally:
        for texture in made.values():
            texture.release()


@pytest.fixture
def spoil(monkeypatch: pytest.MonkeyPatch) -> Spoil:
    """Makes a mistake in a shader while entered: `with spoil(file, right, wrong): ...`."""

    @contextmanager
    def spoiled(file: str, right: str, wrong: str) -> Iterator[None]:
        read = source._read

        def reads(root: Any, name: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
            raw, clean = read(root, name)
            if name != file:
                return raw, clean
            text = "\n".join(raw)
            assert text.count(right) == 1, f"{file} has not exactly one {right!r}"
            lines = tuple(text.replace(right, wrong).split("\n"))
            return lines, tuple("" if line.lstrip().startswith("//") else line for line in lines)

        with monkeypatch.context() as patch:
            patch.setattr(source, "_read", reads)
            program._frame.cache_clear()
            program.pass_source.cache_clear()
            yield
        program._frame.cache_clear()
        program.pass_source.cache_clear()

    return spoiled


@pytest.fixture(scope="session")
def judge(thread: GLThread, paint: Paint, pytestconfig: pytest.Config) -> Judge:
    """Holds techniques to the reference and to frozen pictures."""
    return Judge(thread, paint, pytestconfig.getoption("--regenerate"))
