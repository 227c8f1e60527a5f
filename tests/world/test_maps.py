"""Maps of one quantity: the same numbers from every kind of file, and bad ones refused in words."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from renderer.core.errors import AssetError, LimitError
from renderer.world.limits import Limits
from renderer.world.maps import load_map, spread
from renderer.world.upload import check_in_worker, recognise
from tests.world.geotiff import tiff

VALUES = np.array([[0, 51, 102], [153, 204, 255]], np.uint8)


def kept(path: Path) -> Path:
    """The values in the format of a file's name."""
    if path.suffix == ".npz":
        np.savez(path, density=VALUES, elevation=np.zeros((2, 2)))
    elif path.suffix == ".tif":
        tiff(path.parent, VALUES).rename(path)
    elif path.stem == "sixteen":
        Image.fromarray(VALUES.astype(np.uint16) * 257).save(path)
    else:
        Image.fromarray(VALUES).save(path)
    return path


@pytest.mark.parametrize(
    ("name", "full"), [("a.npz", 255), ("a.png", 255), ("sixteen.png", 65535), ("a.tif", 1)]
)
def test_every_format_gives_its_numbers_row_0_first(tmp_path: Path, name: str, full: float) -> None:
    values, largest = load_map(kept(tmp_path / name), "density")
    assert largest == full
    np.testing.assert_array_equal(values * (255 / full if full > 1 else 1), VALUES)


def test_bad_maps_are_refused_in_words(tmp_path: Path) -> None:
    path = tmp_path / "x.npz"
    for array, words in ((np.full((2, 2), np.nan), "not finite"), (np.zeros((2, 2, 2)), "rows x columns"),
                         (np.array([["a"]]), "numbers"), (np.zeros((0, 2)), "at least one")):
        np.savez(path, density=array)
        with pytest.raises(AssetError, match=words):
            load_map(path, "density")
    with pytest.raises(AssetError, match="not among the arrays"):
        load_map(path, "species")
    np.savez(path, density=np.zeros((3, 3)))
    with pytest.raises(LimitError, match="at most 64"):
        load_map(path, "density", Limits(cells=8))
    path.write_bytes(b"nothing of the kind")
    with pytest.raises(AssetError, match="no picture"):
        load_map(path, "density")


def test_an_upload_is_recognised_and_previewed(tmp_path: Path) -> None:
    path = tmp_path / "x.npz"
    np.savez(path, density=VALUES)
    assert recognise(path) == "map"
    shown = check_in_worker(path, "map")
    assert (shown["quantity"], shown["rows"], shown["columns"]) == ("density", 2, 3)
    assert shown["values"] == {"lowest": 0, "highest": 255, "full": 255}


def test_a_map_stretched_keeps_its_mean_and_its_north() -> None:
    ramp = np.repeat(np.linspace(1, 0, 40)[:, None], 40, axis=1)
    for count in (10, 40, 160):
        made = spread(ramp, count)
        assert made.shape == (count, count)
        assert made.mean() == pytest.approx(0.5, abs=1e-6)
        assert made[0].mean() > 0.95
    np.testing.assert_allclose(spread(ramp, 40), ramp, atol=1e-12)
    dots = np.indices((64, 64)).sum(axis=0) % 2.0
    assert np.ptp(spread(dots, 8)) < 0.05, "no detail aliases"
