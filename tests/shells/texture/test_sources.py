"""Every source of 3D texture: what it promises of its arrays, and what it refuses."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from pydantic import TypeAdapter

from renderer.core.cache import AssetStore
from renderer.core.errors import AssetError
from renderer.core.params import union_members
from renderer.shells.texture.block import opacity_at, texture_of
from renderer.shells.texture.source import Procedure, Source
from renderer.shells.texture.sources import Texture, bake_texture, moment_of, texture_bake

SMALL = {"across": 32, "layers": 8}
COARSE: dict[str, dict[str, object]] = {
    "fur": {"strands": 10}, "rocks": {"stones": 4}, "wood": {"rings": 2.0}, "mesh": {"copies": 2},
}
"""What makes details larger than a voxel of a small block."""
PROCEDURES = sorted(kind for kind, model in union_members(Texture).items() if issubclass(model, Procedure))


def source(**said: object) -> Source:
    made: Source = TypeAdapter(Texture).validate_python(said)
    return made


def baked(**said: object) -> dict[str, np.ndarray]:
    return dict(bake_texture(texture_bake(source(**said)).arguments, {}, lambda fraction, words: None))


@pytest.mark.parametrize("kind", PROCEDURES)
def test_a_procedure_keeps_its_promises(kind: str) -> None:
    block = baked(kind=kind, **SMALL)
    assert block["colour"].shape == block["normal"].shape == (8, 32, 32, 4)
    assert block["material"].shape == (8, 32, 32)
    assert block["colour"].min() >= 0
    assert block["colour"].max() <= 1
    length = np.linalg.norm(block["normal"][..., :3].astype(float), axis=-1)
    assert np.all((length < 1e-6) | (np.abs(length - 1) < 2e-3))
    assert np.all((block["material"] > 0) == (block["colour"][..., 3] > 0))
    assert (block["material"] > 0).any()
    np.testing.assert_allclose(block["size"], [4, 4, 1])
    again = baked(kind=kind, **SMALL)
    assert all(np.array_equal(block[name], again[name]) for name in block)


def steps(block: np.ndarray, axis: int) -> np.ndarray:
    """Mean square of the step from each slice across an axis to the next, the last one's to the first."""
    slices = np.moveaxis(block, axis, 0).reshape(block.shape[axis], -1).astype(float)
    return ((slices - np.roll(slices, -1, axis=0)) ** 2).mean(axis=1)


@pytest.mark.parametrize("kind", sorted(set(PROCEDURES) - {"uniform"}))
def test_a_procedure_repeats_without_a_seam(kind: str) -> None:
    """The step across the seam is one like the others; where a block is cut elsewhere it is larger."""
    made = baked(**{"kind": kind, "across": 64, "layers": 16, **COARSE.get(kind, {})})
    block = np.concatenate([made["colour"], made["normal"]], axis=-1)
    for axis in (1, 2):
        found = steps(block, axis)
        assert found[-1] <= found[:-1].max()
        cuts = [np.moveaxis(block, axis, 0)[:width] for width in range(27, 46)]
        assert np.mean([((cut[-1] - cut[0]) ** 2).mean() for cut in cuts]) > 1.5 * found.mean()


def test_a_uniform_absorber_has_its_optical_depth() -> None:
    said = source(kind="uniform", optical_depth=1.3)
    texture = texture_of(bake_texture(texture_bake(said).arguments, {}, lambda *_: None), 0.25, **moment_of(said))
    np.testing.assert_allclose(texture.extinction().mean() * 0.25, 1.3, rtol=1e-6)


def test_fur_grows_and_thickens() -> None:
    fur = baked(kind="fur", **SMALL)
    held = [float(opacity_at(fur, growth=growth).sum()) for growth in (0.0, 0.3, 0.6, 1.0)]
    assert held[0] == 0
    assert held[0] < held[1] < held[2] < held[3]
    tops = [np.flatnonzero(opacity_at(fur, growth=growth).any(axis=(1, 2))).max() for growth in (0.3, 0.6, 1.0)]
    assert tops[0] < tops[1] < tops[2]
    share = opacity_at(fur, density=0.5).sum() / opacity_at(fur).sum()
    assert 0.4 < share < 0.6
    assert opacity_at(fur, density=0.0).max() == 0


def test_the_jelly_fades_and_the_balls_stay() -> None:
    said = source(kind="jelly", second_opacity=0.25, **SMALL)
    jelly = baked(kind="jelly", **SMALL)
    faded = texture_of(jelly, 1.0, **moment_of(said)).colour[..., 3]
    full = jelly["colour"][..., 3]
    second = jelly["material"] == 2
    np.testing.assert_allclose(faded[second], 0.25 * full[second], rtol=1e-6)
    np.testing.assert_array_equal(faded[~second], full[~second])


def test_some_balls_glow_and_the_jelly_does_not() -> None:
    dark, lit = baked(kind="jelly", **SMALL), baked(kind="jelly", glowing=0.5, **SMALL)
    assert not dark["normal"][..., 3].any()
    glows = lit["normal"][..., 3] > 0
    assert glows.any()
    assert (lit["colour"][glows] == dark["colour"][glows]).all()
    assert not glows[lit["colour"][..., 3] < 0.1].any()


@pytest.fixture
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., str]:
    """Keeps arrays as an uploaded volume and says its name."""
    monkeypatch.setenv("UMBRAGE_CACHE", str(tmp_path))

    def keep(**arrays: np.ndarray) -> str:
        file = io.BytesIO()
        np.savez(file, **arrays)
        return "asset:" + AssetStore().put(file.getvalue(), "volume", "own.npz")

    return keep


def test_a_volume_of_ones_own_goes_in(kept: Callable[..., str]) -> None:
    rng = np.random.Generator(np.random.PCG64(3))
    rgba = rng.random((3, 4, 5, 4))
    name = kept(rgba=rgba, alpha=np.array("straight"), reference_length=np.array(0.02))
    block = baked(kind="asset", asset=name)
    np.testing.assert_allclose(block["colour"], rgba, rtol=3e-7)
    texture = texture_of(block, 5.0)
    assert texture.reference_length == 0.02
    np.testing.assert_allclose(texture.size, [0.1, 0.08, 0.06])
    np.testing.assert_allclose(
        texture.extinction(), -np.log(1 - np.minimum(rgba[..., 3], 1 - 2.0**-12)) / 0.02, rtol=1e-5
    )


def heterogeneous() -> tuple[np.ndarray, np.ndarray]:
    """Extinction (32, 64, 64) per metre and straight colour of soft balls in a box of 1 by 1 by 0.5 m, float64."""
    rng = np.random.Generator(np.random.PCG64(12345))
    centre, radius = rng.random((24, 3)) * [1, 1, 0.5], 0.05 + 0.10 * rng.random(24)
    colour, most = 0.1 + 0.9 * rng.random((24, 3)), 20 + 60 * rng.random(24)
    z, y, x = np.meshgrid(*[(np.arange(n) + 0.5) / 64 for n in (32, 64, 64)], indexing="ij")
    off = ((np.stack([x, y, z], -1)[..., None, :] - centre) ** 2).sum(-1) / radius**2
    parts = most * np.maximum(0, 1 - off) ** 2
    extinction = parts.sum(-1)
    there = np.broadcast_to(extinction[..., None] > 0, (32, 64, 64, 3))
    mean = np.divide(parts @ colour, extinction[..., None], out=np.zeros((32, 64, 64, 3)), where=there)
    return extinction, mean


@pytest.mark.parametrize("alpha", ["straight", "associated"])
def test_a_thin_volume_keeps_its_precision(kept: Callable[..., str], alpha: str) -> None:
    """Opacities of a 64th of a metre come back as the extinctions that they were made of, to single precision."""
    extinction, colour = heterogeneous()
    opacity = -np.expm1(-extinction / 64)
    stored = colour if alpha == "straight" else colour * opacity[..., None]
    rgba = np.concatenate([stored, opacity[..., None]], axis=-1)
    name = kept(rgba=rgba, alpha=np.array(alpha), reference_length=np.array(1 / 64))
    texture = texture_of(baked(kind="asset", asset=name), 0.5)
    there = opacity > 0
    error = np.abs(texture.extinction() - extinction)
    assert (error <= 64 * 2.0**-23 + 2e-7 * extinction).all()
    np.testing.assert_allclose(texture.colour[..., :3][there], colour[there], rtol=5e-7)
    np.testing.assert_allclose(texture.size, [1, 1, 0.5])
    assert texture.colour.dtype == np.float32


def test_a_straight_volume_keeps_the_colour_of_nothing(kept: Callable[..., str]) -> None:
    """Straight interpolation mixes it in: black instead would darken every edge."""
    rgba = np.zeros((2, 2, 2, 4))
    rgba[..., :3] = 0.7
    rgba[0, ..., 3] = 0.5
    block = baked(kind="asset", asset=kept(rgba=rgba, alpha=np.array("straight"), reference_length=np.array(1.0)))
    np.testing.assert_allclose(block["colour"][..., :3], 0.7, rtol=1e-6)


def test_what_a_volume_lacks_is_said_in_words(kept: Callable[..., str]) -> None:
    with pytest.raises(AssetError, match=r"texture\.reading\.reference_length"):
        baked(kind="asset", asset=kept(rgba=np.ones((2, 2, 2, 4))))
    with pytest.raises(AssetError, match=r"texture\.asset"):
        baked(kind="asset", asset="asset:" + "0" * 64)
