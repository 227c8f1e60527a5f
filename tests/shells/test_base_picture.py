"""Pictures on the surface under the shell, beside the reference and beside what the Earth is known to look like."""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from PIL import Image

from renderer.core.cache import AssetStore
from renderer.core.errors import InputError
from renderer.core.params import bake_arguments, validate
from renderer.shells.base_picture import MOST_TEXELS, bake_picture, halves, reduced
from renderer.shells.state import ShellsState
from tests.shells.conftest import even
from tests.shells.test_against_reference import GLOBE, SIZE, apart, reference

Draw = Callable[..., np.ndarray]

CLEAR = even(0.0)
PAINTED = {**GLOBE, "base": {"opaque": True, "colour": [1, 1, 1]}}


def uploaded(pixels: np.ndarray) -> str:
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, "PNG")
    return "asset:" + AssetStore().put(file.getvalue(), "image", "picture.png")


def waves() -> np.ndarray:
    """A smooth picture without a symmetry, finer across than up, (24, 40, 3) codes."""
    v, u = np.meshgrid((np.arange(24) + 0.5) / 24, (np.arange(40) + 0.5) / 40, indexing="ij")
    turn = 2 * np.pi
    colours = [np.sin(turn * u) + v, np.cos(2 * turn * u) * v, np.sin(turn * (u + v))]
    return np.uint8(127 + 60 * np.stack(colours, axis=-1))


def earth() -> np.ndarray:
    return bake_picture({"kind": "earth"}, {}, lambda share, words: None)["picture"]


@pytest.mark.parametrize("laid", ["globe", "texture"])
def test_a_picture_lies_where_the_reference_has_it(draw: Draw, laid: str) -> None:
    picture = {"kind": "asset", "asset": uploaded(waves()), "laid": laid, "turn": 25.0, "across": 2.0, "upwards": 1.5}
    patch = {**PAINTED, "picture": picture}
    found, right = draw(patch, CLEAR, size=SIZE), reference(patch, CLEAR)
    assert apart(found, right) < 0.002, "half floats, and sines of single precision"
    mirrored = uploaded(np.ascontiguousarray(waves()[:, ::-1]))
    assert apart(found, reference({**patch, "picture": {**picture, "asset": mirrored}}, CLEAR)) > 0.1


def test_a_distant_camera_sees_the_means_of_fine_texels(draw: Draw) -> None:
    """A chequered picture of single texels is even grey from where a pixel holds four of them."""
    fine = np.zeros((1024, 1024, 3), np.uint8)
    fine[::2, ::2] = fine[1::2, 1::2] = 255
    patch = {**PAINTED, "picture": {"kind": "asset", "asset": uploaded(fine)}}
    found = draw(patch, CLEAR, size=SIZE)
    middle = found[10:14, 10:14, :3]
    assert np.allclose(middle, 0.5, atol=0.01)


def test_the_earth_has_its_continents_where_they_are() -> None:
    """By reflectance: desert, ice and forest against the sea, at four places of the globe and their antipodes."""
    picture = earth()
    rows, columns = picture.shape[:2]

    def at(latitude: float, longitude: float) -> np.ndarray:
        row, column = int((0.5 + latitude / 180) * rows), int((0.5 + longitude / 360) * columns) % columns
        return picture[row - 2 : row + 3, column - 2 : column + 3].mean(axis=(0, 1))

    sahara, ice, amazon, sea = at(23, 10), at(-80, 60), at(-5, -62), at(-30, -120)
    assert sahara[0] > 0.3
    assert ice.min() > 0.5
    assert amazon[1] > amazon[2]
    assert sea[0] < 0.02
    assert at(-23, -170)[0] < 0.05, "no desert on the other side"


def test_reduced_pictures_keep_their_mean() -> None:
    values = np.random.default_rng(3).random((37, 53, 3))
    assert np.allclose(reduced(reduced(values, 11, 0), 17, 1).mean(axis=(0, 1)), values.mean(axis=(0, 1)))
    assert [level.shape[:2] for level in halves(values[:5, :9])] == [(5, 9), (2, 4), (1, 2), (1, 1)]
    wide = np.zeros((8, MOST_TEXELS + 100, 3), np.uint8)
    state = validate(ShellsState, {"scene": "shells", "picture": {"kind": "asset", "asset": uploaded(wide)}})
    arguments: dict[str, Any] = bake_arguments(state.picture)
    assert bake_picture(arguments, {}, lambda share, words: None)["picture"].shape == (8, MOST_TEXELS, 3)


def test_a_lost_picture_is_refused_by_its_name() -> None:
    with pytest.raises(InputError) as refused:
        bake_picture({"kind": "asset", "asset": "asset:" + "0" * 64}, {}, lambda share, words: None)
    assert refused.value.field == "picture.asset"
    torn = "asset:" + AssetStore().put(b"\x89PNG\r\n\x1a\n torn", "image", "torn.png")
    with pytest.raises(InputError) as refused:
        bake_picture({"kind": "asset", "asset": torn}, {}, lambda share, words: None)
    assert refused.value.field.startswith("picture.asset")
