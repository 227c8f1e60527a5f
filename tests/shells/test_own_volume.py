"""A volume of one's own on a flat shell, at every door: three pictures computed elsewhere."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from renderer.core.cache import AssetStore
from renderer.session import Session
from server import cli

ROOT = Path(__file__).parents[2]
STATE = ROOT / "docs" / "volume_on_a_shell.json"
PIXELS = json.loads((ROOT / "tests" / "references" / "shells" / "volume.json").read_text())
SHARED = ROOT.parent / "shared" / "reference" / "d_volume_images.npz"
WHOLE = {"extinction": "assoc_trilinear", "straight": "straight_trilinear", "nearest": "voxel_constant_exact"}


def volume(path: Path) -> Path:
    """The volume of the shared reference, by its recipe: 24 soft balls in 64 x 64 x 32 voxels."""
    rng = np.random.Generator(np.random.PCG64(12345))
    centres, radii = rng.random((24, 3)) * [1, 1, 0.5], 0.05 + 0.10 * rng.random(24)
    colours, strengths = 0.1 + 0.9 * rng.random((24, 3)), 20 + 60 * rng.random(24)
    z, y, x = np.meshgrid(*((np.arange(n) + 0.5) / 64 for n in (32, 64, 64)), indexing="ij")
    away = ((np.stack([x, y, z], -1)[..., None, :] - centres) ** 2).sum(-1) / radii**2
    parts = strengths * np.maximum(0, 1 - away) ** 2
    sigma = parts.sum(-1)
    colour = np.divide(parts @ colours, sigma[..., None], out=np.zeros((*sigma.shape, 3)), where=sigma[..., None] > 0)
    rgba = np.concatenate([colour, 1 - np.exp(-sigma / 64)[..., None]], -1)
    np.savez(path, rgba=rgba, alpha="straight", reference_length=1 / 64, size=(1.0, 1.0, 0.5))
    return path


@pytest.fixture(scope="module")
def session() -> Iterator[Session]:
    with Session() as made:
        yield made


def drawn(session: Session, tmp_path: Path, interpolation: str, sampling: Mapping[str, Any]) -> np.ndarray:
    """128 x 128 pixels of it, linear."""
    asset = AssetStore().put(volume(tmp_path / "volume.npz").read_bytes(), "volume", "volume.npz")
    document = {**json.loads(STATE.read_text()), "texture": {"kind": "asset", "asset": f"asset:{asset}"}}
    document["voxels"]["interpolation"] = interpolation
    state = session.state("shells", None, {**document, "sampling": sampling})
    return np.asarray(session.draw(state, 128, 128, 1).linear)


def error(picture: np.ndarray, right: np.ndarray) -> float:
    """Relative root mean square error of the colours."""
    return float(np.sqrt(((picture - right)[..., :3] ** 2).mean()) / right[..., :3].mean())


@pytest.mark.parametrize("interpolation", WHOLE)
def test_voxel_by_voxel_it_is_the_picture_computed_elsewhere(
    session: Session, interpolation: str, tmp_path: Path
) -> None:
    picture = drawn(session, tmp_path, interpolation, {"kind": "dda"})
    rows, columns = np.array(PIXELS["pixels"]).T
    assert error(picture[rows, columns], np.array(PIXELS[interpolation])) < 0.005
    other = "nearest" if interpolation != "nearest" else "straight"
    assert error(picture[rows, columns], np.array(PIXELS[other])) > 0.01, "interpolations are told apart"
    if SHARED.is_file():
        assert error(picture, np.load(SHARED)[WHOLE[interpolation]]) < 0.005


def test_the_command_line_draws_it(tmp_path: Path) -> None:
    out, file = tmp_path / "out.npy", volume(tmp_path / "volume.npz")
    given = ["--state", str(STATE), "--set", "texture.kind=asset", "--set", f"texture.asset={file}"]
    assert cli.main(["render", "shells", *given, "--size", "128x128", "-o", str(out)]) == 0
    rows, columns = np.array(PIXELS["pixels"]).T
    assert error(np.load(out)[rows, columns], np.array(PIXELS["extinction"])) < 0.005


def test_opacity_does_not_depend_on_the_number_of_steps(session: Session, tmp_path: Path) -> None:
    few, many = (
        drawn(session, tmp_path, "extinction", {"kind": "uniform", "samples": count})[..., 3].mean()
        for count in (24, 48)
    )
    assert few == pytest.approx(many, rel=0.01)
