"""Piles of pictures as volumes: order, codes, and what is refused."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from renderer.core.errors import AssetError, LimitError
from renderer.world.limits import Limits, Unsaid
from renderer.world.upload import recognise
from renderer.world.volume import VolumeReading, load_volume

SAID = VolumeReading(reference_length=0.5)


def png(pixels: np.ndarray) -> bytes:
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, "PNG")
    return file.getvalue()


def stack(path: Path, **pictures: bytes) -> Path:
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in pictures.items():
            archive.writestr(name, data)
    return path


def layer(level: int) -> np.ndarray:
    """2 rows of 3 pixels; the north-western one is clear, the others have the level as their alpha."""
    pixels = np.full((2, 3, 4), (255, 188, 0, level), np.uint8)
    pixels[0, 0, 3] = 0
    return pixels


def test_layers_lie_in_the_order_of_their_numbers(tmp_path: Path) -> None:
    path = stack(tmp_path / "s.zip", **{f"slice{n}.png": png(layer(n)) for n in (10, 2, 33)})
    assert recognise(path) == "volume"
    volume = load_volume(path, reading=SAID)
    assert volume.rgba.shape == (3, 2, 3, 4)
    np.testing.assert_allclose(volume.rgba[:, 0, 1, 3] * 255, (2, 10, 33), rtol=1e-6)
    # Row 0 is south; straight colours are linear light, and kept where nothing is.
    np.testing.assert_array_equal(volume.rgba[:, 1, 0], 0)
    np.testing.assert_allclose(volume.colour()[:, 1, 0], np.broadcast_to((1, 0.5029, 0), (3, 3)), atol=1e-4)
    assert volume.size == (1.5, 1.0, 1.5)
    assert any("slice2.png" in note for note in volume.notes)


def test_without_alpha_brightness_is_opacity(tmp_path: Path) -> None:
    path = stack(tmp_path / "s.zip", **{"a.png": png(np.array([[0, 51, 255]], np.uint8))})
    volume = load_volume(path, reading=SAID)
    np.testing.assert_allclose(volume.rgba[0, 0, :, 3], (0, 0.2, 1), rtol=1e-6)
    assert any("brightness" in note for note in volume.notes)


def test_what_is_no_stack_is_refused_in_words(tmp_path: Path) -> None:
    sound = png(layer(9))
    with pytest.raises(Unsaid, match="reference_length"):
        load_volume(stack(tmp_path / "a.zip", **{"1.png": sound}))
    with pytest.raises(AssetError, match="different sizes"):
        load_volume(stack(tmp_path / "b.zip", **{"1.png": sound, "2.png": png(layer(9)[:1])}), reading=SAID)
    with pytest.raises(AssetError, match="no PNG"):
        load_volume(stack(tmp_path / "c.zip", **{"1.png": b"GIF89a"}), reading=SAID)
    with pytest.raises(AssetError, match="PNG"):
        load_volume(stack(tmp_path / "d.zip", **{"1.png": sound[:60]}), reading=SAID)
    with pytest.raises(AssetError, match="rgba"):
        load_volume(stack(tmp_path / "e.zip", **{"1.png": sound, "read.me": b"x"}), reading=SAID)
    with pytest.raises(LimitError, match="voxels"):
        load_volume(stack(tmp_path / "f.zip", **{"1.png": sound}), Limits(voxels=5), SAID)
