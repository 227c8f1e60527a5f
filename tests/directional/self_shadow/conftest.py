"""What the tests of self-shadow share: masks with known answers, and a technique's GLSL read through the probe."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np
import pytest

from renderer.core.params import defines, uniform_declarations, uniforms
from renderer.core.registry import glsl_file
from renderer.directional.codes.code import cells_of, places_of
from renderer.directional.hemisphere import Hemisphere
from renderer.gl.probe import probe
from renderer.gl.program import AnyTexture
from renderer.gl.thread import GLThread

SURFEL = """struct Surfel {
    uint index; vec3 position; vec3 normal; vec3 tangent; vec3 bitangent; vec3 colour; float openness;
};
uniform usampler2D code_words;
uvec4 shadow_words(uint point, int block) { return texelFetch(code_words, ivec2(block, int(point)), 0); }"""

BODY = """Surfel surfel = Surfel(point, vec3(0.0), vec3(0.0, 0.0, 1.0), vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0),
                       vec3(0.0), 0.0);
result = self_shadow_visibility(surfel, towards);"""

ARC = 6e-3
"""By how much GLSL and numpy may differ: Mesa's arc sine errs by up to 4e-4, of rows 0.09 apart or more."""

See = Callable[..., np.ndarray]


@pytest.fixture(scope="session")
def thread() -> Iterator[GLThread]:
    """A running OpenGL thread, closed without a leak after these tests."""
    with GLThread("self-shadow-tests") as running:
        yield running


@pytest.fixture(scope="session")
def see(thread: GLThread) -> See:
    """Visibilities (M,) that a technique's GLSL reads of words (M, W), in local directions (M, 3):
    `see(technique, layout, words, towards, tables, uniforms..)`."""

    def seen(
        technique: Any,
        layout: Hemisphere,
        words: np.ndarray,
        towards: np.ndarray,
        tables: Mapping[str, np.ndarray] | None = None,
        **values: Any,
    ) -> np.ndarray:
        return thread.call(_seen, technique, layout, words, towards, dict(tables or {}), values)

    return seen


def _seen(
    gl: Any, technique: Any, layout: Hemisphere, words: np.ndarray, towards: np.ndarray, tables: dict, more: dict
) -> Any:
    blocks = -(-words.shape[1] // 4)
    filled = np.zeros((len(words), 4 * blocks), np.uint32)
    filled[:, : words.shape[1]] = words
    textures: dict[str, AnyTexture] = {
        "code_words": gl.texture2d(filled.reshape(len(words), blocks, 4), filter="nearest"),
        **{f"self_shadow_{name}": made for name, made in technique.textures_of(gl, {"shadow_code": tables}).items()},
    }
    values = {"self_shadow_azimuths": layout.azimuths, "self_shadow_elevations": layout.elevations, **more}
    samplers = [f"uniform {kind} self_shadow_{name};" for name, kind in technique.textures.items()]
    given = [uniform_declarations(type(technique), "self_shadow"), *technique.extra_declarations, *samplers, SURFEL]
    own = glsl_file("directional", "self_shadow", technique.kind)
    try:
        return probe(
            gl,
            ["directional/hemisphere.glsl", *technique.includes, own],
            BODY,
            {"point": np.arange(len(words), dtype=np.uint32), "towards": towards},
            uniforms={**values, **uniforms(technique, "self_shadow")},
            textures=textures,
            declarations="\n".join(given),
            defines=defines(technique, "self_shadow"),
        )[:, 0]
    finally:
        for texture in textures.values():
            texture.release()


def towards(count: int, seed: int = 3) -> np.ndarray:
    """Unit vectors (count, 3), spread evenly over the sphere: half of them below the horizon."""
    drawn = np.random.default_rng(seed).normal(size=(count, 3))
    return np.asarray(drawn / np.linalg.norm(drawn, axis=1, keepdims=True))


def twin(code: Any, words: np.ndarray, towards: np.ndarray) -> np.ndarray:
    """What the numpy code says of one direction (M, 3) a point, as a technique shows it."""
    value = code.evaluate(words, places_of(code.layout, towards)[:, None])[:, 0]
    return np.where(towards[:, 2] > 0, np.clip(value, 0, 1), 0)


def caps(layout: Hemisphere, count: int, seed: int = 1) -> np.ndarray:
    """Masks (count, n) of skies with some round obstacles each."""
    rng = np.random.default_rng(seed)
    axes = rng.normal(size=(count, 4, 3))
    axes /= np.linalg.norm(axes, axis=-1, keepdims=True)
    axes[..., 2] = np.abs(axes[..., 2])
    across = np.cos(rng.uniform(0.2, 0.6, (count, 4)))
    inside = np.einsum("nkc,dc->nkd", axes, layout.directions()) > across[..., None]
    return np.asarray(~inside.any(axis=1))


def horizons(layout: Hemisphere, count: int, seed: int = 2) -> np.ndarray:
    """Masks (count, n) of skies above smooth horizons."""
    rng = np.random.default_rng(seed)
    turn = np.arange(layout.azimuths) * 2 * np.pi / layout.azimuths
    waves = rng.uniform(-0.3, 0.3, (count, 3, 1)) * np.cos(
        np.arange(1, 4)[None, :, None] * turn + rng.uniform(0, 6.28, (count, 3, 1))
    )
    height = rng.uniform(0, 0.8, (count, 1)) + waves.sum(axis=1)
    lit = layout.elevation()[None, :, None] > height[:, None]
    return np.concatenate([lit.reshape(count, -1), np.ones((count, 1), bool)], axis=1)


DEM_X4 = """
    1111100113332221 4420000123444555 3211123344445554 1110001110000001 0011023444333100 2334443210112233
    1111111111100111 0023444443110000 0111101233322100 1111210001123332 4432012222111344 2122213322245554
    1222221222310111 5554310112343345 2221222221222222 3222221111101333 2122333222221223 1100355555300001
    1211110000001111 3221111355555454 0111122221110001 5543210112222445 0000000111111211 0012222111100010
    5421223232112455 0000010001101100 0111111122333321 5554312344443345 0000003444566653 2444455423333444
    4210000010244555 1000012112344431 1000000000111222 1112100121211122 2111123333344433 3454321355555433
    0122222111111110 0002456555443200 4234566533201244 1112332332333111 2444344321000122 2221245555543211
    3233245554200002 0011111222111111 5554113443333345 1211123344433322 0000013444566654 4211344455432234
    1122333331211111 2333212323343222
"""
"""Dark rows of 16 azimuths at 50 nodes of matplotlib's elevation model, four times as high: the exact horizons of the
acceptance references (e_dem_horizons.npz) against rows 11.25 degrees apart, which are the masks `dem_x4` of
g_shadow9.json."""


def dem_x4() -> np.ndarray:
    """Those masks (50, 129), the zenith lit."""
    dark = np.array([[int(digit) for digit in word] for word in DEM_X4.split()])
    lit = np.arange(8)[None, :, None] >= dark[:, None, :]
    return np.concatenate([lit.reshape(50, 128), np.ones((50, 1), bool)], axis=1)


def errors(code: Any, masks: np.ndarray) -> tuple[float, float]:
    """Root mean square of what a code makes of rows of masks, clamped, and share of directions that it misjudges."""
    raw = code.evaluate(code.encode(masks), cells_of(code.layout))[:, :-1]
    rows = masks[:, :-1]
    return float(np.sqrt(((np.clip(raw, 0, 1) - rows) ** 2).mean())), float(((raw > 0.5) != rows).mean())


def leaves(layout: Hemisphere, count: int, seed: int = 4) -> np.ndarray:
    """Masks (count, n) of skies behind many small leaves, which no code of nine bytes holds."""
    rng = np.random.default_rng(seed)
    axes = rng.normal(size=(count, 60, 3))
    axes /= np.linalg.norm(axes, axis=-1, keepdims=True)
    axes[..., 2] = np.abs(axes[..., 2])
    inside = np.einsum("nkc,dc->nkd", axes, layout.directions()) > np.cos(0.16)
    return np.asarray(~inside.any(axis=1))
