"""Reflectances in: MERL files and tables of one's own, checked; bad ones refused in words."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from renderer.core.cache import AssetStore
from renderer.core.errors import AssetError, InputError, LimitError
from renderer.world.brdf_files import MERL_HEAD, MERL_SCALE, MERL_SHAPE, load_brdf
from renderer.world.limits import Limits
from renderer.world.upload import recognise
from renderer.world.upload_preview import PREVIEWS

THETA, PHI = np.array([0.0, 30, 60, 85]), np.array([0.0, 90, 180, 270])
SOUND: dict[str, Any] = {"brdf": np.full((4, 4, 4, 3), 0.2), "theta_o": THETA, "theta_l": THETA, "delta_phi": PHI}
FOUR: dict[str, Any] = {"brdf": np.full((4, 4, 4, 4, 3), 0.2), "theta_o": THETA, "phi_o": PHI, "theta_l": THETA,
                        "phi_l": PHI}  # fmt: skip


def npz(path: Path, **arrays: Any) -> Path:
    np.savez(path, **arrays)
    return path


def merl(path: Path, values: np.ndarray) -> Path:
    """A MERL file of reflectances (90, 90, 180, 3) [sr-1]; negative where there is none."""
    stored = np.moveaxis(values / MERL_SCALE, -1, 0).astype("<f8")
    path.write_bytes(MERL_HEAD + stored.tobytes())
    return path


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A MERL file whose red says the half angle's cell, green the difference angle's, blue the azimuth's."""
    h, d, p = np.meshgrid(*map(np.arange, MERL_SHAPE), indexing="ij")
    values = np.stack([h + 1.0, d + 1.0, p + 1.0], axis=-1)
    values[:, 80:] = -1.0
    return merl(tmp_path_factory.mktemp("merl") / "own.dat", values)


def test_a_merl_file_has_its_cells_where_they_belong(file: Path) -> None:
    table = load_brdf(file)
    assert (table.coordinates, table.values.shape) == ("half", (90, 1, 90, 180, 3))
    assert table.values[4, 0, 7, 100] == pytest.approx([5, 8, 101])
    root, _, theta_d, phi_d = table.nodes
    assert np.degrees(root[0] ** 2 * np.pi / 2) == pytest.approx(90 * (0.5 / 90) ** 2)  # square roots of half angles
    assert np.degrees(theta_d[[0, -1]]) == pytest.approx([0.5, 89.5])
    assert np.degrees(phi_d[[0, -1]]) == pytest.approx([0.5, 179.5])
    # what is marked invalid takes the nearest valid angle's value instead of darkening its neighbours
    assert table.values[4, 0, 85, 100] == pytest.approx([5, 80, 101])
    assert "11.1%" in table.notes[0]


def test_files_are_recognised_checked_and_kept(file: Path, tmp_path: Path) -> None:
    own = npz(tmp_path / "own.npz", **SOUND)
    assert recognise(file) == recognise(own) == "brdf"
    store = AssetStore(tmp_path / "assets")
    preview = PREVIEWS["brdf"](own, Limits(), {})
    assert preview["directions"] == [4, 4, 4]
    assert preview["values"] == {"lowest": 0.2, "highest": 0.2}
    assert store.get(store.put(b"data", "brdf", "gold-metallic-paint.binary")).path.suffix == ".binary"
    assert PREVIEWS["brdf"](file, Limits(), {})["coordinates"] == "root_theta_h, theta_d, phi_d"
    with pytest.raises(InputError, match="leaves nothing unsaid"):
        PREVIEWS["brdf"](own, Limits(), {"scale": 1})


def test_half_a_turn_stands_for_both_sides_and_a_whole_one_is_closed(tmp_path: Path) -> None:
    values = np.arange(4 * 4 * 3, dtype=float).reshape(4, 4, 3)[..., None] * [1, 1, 1]
    half = load_brdf(npz(tmp_path / "a.npz", **{**SOUND, "brdf": values, "delta_phi": np.array([0.0, 90, 180])}))
    assert np.degrees(half.nodes[3]) == pytest.approx([0, 90, 180, 270])
    assert half.values[2, 0, 2, 3] == pytest.approx(half.values[2, 0, 2, 1])
    around = np.concatenate([FOUR["brdf"], FOUR["brdf"][:, :1] + 1], axis=1)
    whole = load_brdf(npz(tmp_path / "b.npz", **{**FOUR, "brdf": around, "phi_o": np.append(PHI, 360.0)}))
    assert whole.values.shape == (4, 4, 4, 4, 3)
    assert whole.values.max() == 0.2
    assert "phi_o" in whole.notes[0]


def test_at_the_pole_all_azimuths_are_one(tmp_path: Path) -> None:
    values = np.random.default_rng(1).random((4, 4, 4, 4, 3))
    table = load_brdf(npz(tmp_path / "a.npz", **{**FOUR, "brdf": values}))
    assert np.ptp(table.values[0], axis=0).max() < 1e-12  # the view along the normal
    assert np.ptp(table.values[:, :, 0], axis=2).max() < 1e-12  # the light along it
    assert table.values[1, 2, 3] == pytest.approx(values[1, 2, 3])
    assert "theta = 0" in table.notes[-1]


def without(name: str) -> dict[str, Any]:
    return {key: value for key, value in SOUND.items() if key != name}


@pytest.mark.parametrize(
    ("arrays", "field", "words"),
    [
        (without("brdf"), "brdf", "not among the arrays"),
        (without("theta_l"), "theta_l", "missing"),
        ({**SOUND, "brdf": np.full((4, 4, 4), 0.2)}, "brdf", "shape"),
        ({**SOUND, "brdf": np.full((4, 4, 4, 3), np.nan)}, "brdf", "no reflectance"),
        ({**SOUND, "brdf": np.full((4, 4, 4, 3), -0.1)}, "brdf", "no reflectance"),
        ({**SOUND, "brdf": np.full((4, 4, 4, 3), "x")}, "brdf", "shape"),
        ({**SOUND, "theta_o": THETA[:3]}, "theta_o", "shape"),
        ({**SOUND, "theta_o": THETA + 10}, "theta_o", "out of range"),
        ({**SOUND, "theta_o": THETA[::-1]}, "theta_o", "does not ascend"),
        ({**SOUND, "delta_phi": PHI * 2 - 360}, "delta_phi", "more than once"),
        ({**SOUND, "delta_phi": np.array([0.0, 0.1, 180, 270])}, "delta_phi", "does not ascend"),
    ],
)
def test_bad_tables_are_refused_in_words(tmp_path: Path, arrays: dict, field: str, words: str) -> None:
    with pytest.raises(AssetError, match=words) as refused:
        load_brdf(npz(tmp_path / "bad.npz", **arrays))
    assert refused.value.field == field
    assert refused.value.allowed


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda data: data[:-8], "bytes"),
        (lambda data: data[:12] + b"\xff" * 8 + data[20:], "not finite"),
        (lambda data: data[:12] + np.full(90 * 90 * 180 * 3, -1.0).tobytes(), "no valid value"),
        (lambda data: data[:12] + np.full(1, 1e12).tobytes() + data[20:], "reflectance of"),
        (lambda data: b"\x5b" + data[1:], "no reflectance of a known format"),
    ],
)
def test_bad_merl_files_are_refused_in_words(
    file: Path, tmp_path: Path, spoil: Callable[[bytes], bytes], words: str
) -> None:
    bad = tmp_path / "bad.binary"
    bad.write_bytes(spoil(file.read_bytes()))
    with pytest.raises(AssetError, match=words):
        load_brdf(bad)


def test_limits_are_named(file: Path, tmp_path: Path) -> None:
    for path in (file, npz(tmp_path / "a.npz", **SOUND)):
        with pytest.raises(LimitError):
            load_brdf(path, Limits(brdf_values=50))
