"""The quantity `hemisphere`: codes of given masks and horizons, files, and refusals in words."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from renderer.core.errors import AssetError, InputError, InvalidDocument, LimitError
from renderer.directional.codes.baking import CODE_SIZES
from renderer.directional.hemisphere import hemisphere_of
from renderer.directional.measured_hemisphere import MOST, above, read_masks_file
from renderer.study import measure as door

LAYOUT = hemisphere_of(129)
HALF = [*([1] * 8 + [0] * 8) * 8, 1]


def found(files: Any = None, **arguments: Any) -> Mapping[str, np.ndarray]:
    return door.measure("hemisphere", arguments, files).arrays


def test_half_a_sky_in_nine_bytes() -> None:
    """Mean 128/255; the first harmonic, number 8, at its greatest amplitude, its crest in the middle of what is lit."""
    seen = found(bits=HALF)
    assert seen["code"].shape == (1, 9)
    assert seen["code"][0, 8] == 128
    field = int(seen["code"][0, 0]) | int(seen["code"][0, 1]) << 8
    assert (field & 63, field >> 6 & 31) == (8, 31)
    assert field >> 11 == round((-3.5 / 16 % 1) * 32)
    assert seen["misjudged"][0] == 0
    assert 0.5 < seen["openness"][0] < 0.52


@pytest.mark.parametrize("code", CODE_SIZES)
def test_every_code_has_its_bytes(code: str) -> None:
    for size in CODE_SIZES[code]:
        seen = found(bits=HALF, code=code, **({"size": size} if size else {}))
        assert seen["code"].shape == (1, size or 17)
        np.testing.assert_array_equal(seen["judged"], seen["reconstructed"] > 0.5)
        assert seen["misjudged"][0] == (seen["judged"] != seen["bits"]).mean()
        # A ring of eight sectors blends across the edges of the lit half.
        most = {"spherical_harmonics": 0.02, "horizon_ring": 0.07 if size == 5 else 0}
        assert seen["misjudged"][0] <= most.get(code, 0)


def test_a_level_horizon_opens_by_its_cosine() -> None:
    """sin^2 of the horizon is hidden of an even sky; rows are 10.6 degrees apart."""
    edge = np.degrees(3 * LAYOUT.step)
    seen = found(horizon=[edge] * 4, code="horizon_ring")
    assert seen["openness"][0] == pytest.approx(np.cos(np.radians(edge)) ** 2)
    assert seen["openness_reconstructed"][0] == pytest.approx(seen["openness"][0], abs=1e-9)
    assert seen["misjudged"][0] == 0


def test_horizons_between_azimuths() -> None:
    masks = above(np.radians([[0.0, 60.0]]), LAYOUT)[0, :-1].reshape(8, 16)
    dark = 8 - masks.sum(axis=0)
    assert dark[0] == 0
    assert dark[8] == 6
    assert (np.diff(dark[:9]) >= 0).all()
    assert (dark[1:8] == dark[:8:-1]).all()


def test_files(tmp_path: Path) -> None:
    masks = np.array([HALF, [1] * 129])
    np.savez(tmp_path / "masks.npz", bits=masks)
    np.savez(tmp_path / "horizons.npz", horizon_rad=np.zeros((3, 16)))
    (tmp_path / "masks.csv").write_text("\n".join(",".join(map(str, row)) for row in masks))
    for name in ("masks.npz", "masks.csv"):
        np.testing.assert_array_equal(found({"masks": tmp_path / name}, code="bits")["bits"], masks)
    assert found({"masks": tmp_path / "horizons.npz"}, code="bits")["bits"].all()


@pytest.mark.parametrize(
    ("arguments", "field"),
    [
        ({"bits": [1, 0]}, "bits"),
        ({"bits": HALF, "horizon": [3.0]}, "bits"),
        ({}, "bits"),
        ({"bits": HALF, "directions": 513}, "bits"),
        ({"bits": HALF, "code": "codebook", "size": 33}, "size"),
    ],
)
def test_what_does_not_fit_is_refused(arguments: dict[str, Any], field: str) -> None:
    with pytest.raises(InputError) as refused:
        found(**arguments)
    assert refused.value.field == field


@pytest.mark.parametrize("arguments", [{"bits": [2] * 129}, {"horizon": [91.0]}, {"code": "wavelets"}])
def test_values_out_of_range_are_refused(arguments: dict[str, Any]) -> None:
    with pytest.raises((InvalidDocument, InputError)):
        found(**arguments)


def test_bad_files_are_refused(tmp_path: Path) -> None:
    (tmp_path / "words.csv").write_text("lit, dark")
    np.savez(tmp_path / "two.npz", bits=np.full((1, 129), 2))
    np.savez(tmp_path / "few.npz", bits=np.ones((1, 12)))
    np.savez(tmp_path / "high.npz", horizon_rad=np.full((1, 16), 2.0))
    np.savez(tmp_path / "other.npz", mask=np.ones((1, 129)))
    for name in ("words.csv", "two.npz", "few.npz", "high.npz", "other.npz"):
        with pytest.raises(AssetError):
            read_masks_file(tmp_path / name, LAYOUT)
    np.savez(tmp_path / "many.npz", horizon_rad=np.zeros((MOST + 1, 1)))
    with pytest.raises(LimitError):
        read_masks_file(tmp_path / "many.npz", LAYOUT)
