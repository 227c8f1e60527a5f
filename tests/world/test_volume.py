"""Volumes: alpha straight or associated, opacity against length, and what is refused."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from renderer.core.errors import AssetError, LimitError
from renderer.world.limits import Limits
from renderer.world.volume import VolumeReading, load_volume, save_volume

SAID = VolumeReading(alpha="straight", reference_length=0.5)


def file_of(folder: Path, **arrays: np.ndarray) -> Path:
    path = folder / "volume.npz"
    np.savez(path, **arrays)
    return path


def test_straight_and_associated_describe_the_same_matter(tmp_path: Path) -> None:
    straight = np.zeros((2, 3, 4, 4), dtype=np.float32)
    straight[...] = (0.8, 0.4, 0.2, 0.25)
    associated = straight * (0.25, 0.25, 0.25, 1)
    first = load_volume(file_of(tmp_path, rgba=straight), reading=SAID)
    second = load_volume(
        file_of(tmp_path, rgba=associated), reading=VolumeReading(alpha="associated", reference_length=0.5)
    )
    np.testing.assert_allclose(first.rgba, second.rgba, rtol=1e-6)
    np.testing.assert_allclose(first.colour(), straight[..., :3], rtol=1e-6)
    # The spoiled reading, straight taken as associated, is four times as bright.
    wrong = load_volume(
        file_of(tmp_path, rgba=straight), reading=VolumeReading(alpha="associated", reference_length=0.5)
    )
    np.testing.assert_allclose(wrong.rgba[..., :3], 4 * first.rgba[..., :3], rtol=1e-6)
    assert "24 voxels have more colour than opacity" in wrong.notes[0]


def test_extinction_gives_the_opacity_back_over_the_reference_length(tmp_path: Path) -> None:
    rgba = np.ones((1, 1, 3, 4))
    rgba[0, 0, :, 3] = (0, 0.5, 1)
    sigma = load_volume(file_of(tmp_path, rgba=rgba), reading=SAID).extinction()[0, 0]
    np.testing.assert_allclose(1 - np.exp(-sigma * 0.5), (0, 0.5, 1 - 2.0**-12), rtol=1e-6)
    assert sigma[1] == pytest.approx(2 * math.log(2), rel=1e-6)


@pytest.mark.parametrize(("dtype", "most"), [(np.uint8, 255), (np.uint16, 65535)])
def test_integers_are_shares_of_their_largest_value(dtype: type, most: int, tmp_path: Path) -> None:
    rgba = np.full((2, 2, 2, 4), most, dtype=dtype)
    np.testing.assert_array_equal(load_volume(file_of(tmp_path, rgba=rgba), reading=SAID).rgba, 1)


def test_the_file_may_say_everything_and_the_reader_overrides(tmp_path: Path) -> None:
    path = file_of(
        tmp_path,
        rgba=np.full((2, 3, 4, 4), 0.5, dtype=np.float32),
        alpha=np.array("associated"),
        reference_length=np.array(2.0),
        size=np.array([4.0, 3.0, 1.0]),
    )
    volume = load_volume(path)
    assert (volume.reference_length, volume.size, volume.notes) == (2.0, (4.0, 3.0, 1.0), ())
    assert volume.rgba[0, 0, 0, 0] == 0.5
    other = load_volume(path, reading=VolumeReading(alpha="straight", reference_length=1, size=(1, 2, 3)))
    assert (other.reference_length, other.size) == (1.0, (1.0, 2.0, 3.0))
    assert other.rgba[0, 0, 0, 0] == 0.25


def test_what_is_written_is_read(tmp_path: Path) -> None:
    rng = np.random.Generator(np.random.PCG64(3))
    volume = load_volume(file_of(tmp_path, rgba=rng.uniform(0, 1, (3, 4, 5, 4))), reading=SAID)
    assert volume.size == (2.5, 2.0, 1.5)
    save_volume(tmp_path / "again.npz", volume)
    again = load_volume(tmp_path / "again.npz")
    np.testing.assert_array_equal(again.rgba, volume.rgba)
    assert (again.size, again.reference_length) == (volume.size, volume.reference_length)


GOOD = np.full((2, 2, 2, 4), 0.5)


@pytest.mark.parametrize(
    ("arrays", "field"),
    [
        ({"density": GOOD}, "rgba"),
        ({"rgba": GOOD[..., :3]}, "rgba"),
        ({"rgba": GOOD[0]}, "rgba"),
        ({"rgba": np.zeros((0, 2, 2, 4))}, "rgba"),
        ({"rgba": np.full((2, 2, 2, 4), np.nan)}, "rgba"),
        ({"rgba": GOOD * 4}, "rgba"),
        ({"rgba": -GOOD}, "rgba"),
        ({"rgba": GOOD.astype(np.int64)}, "rgba"),
        ({"rgba": GOOD.astype(complex)}, "rgba"),
        ({"rgba": GOOD}, "reference_length"),
        ({"rgba": GOOD, "reference_length": np.array(-1.0)}, "reference_length"),
        ({"rgba": GOOD, "reference_length": np.array("long")}, "reference_length"),
        ({"rgba": GOOD, "reference_length": np.array(1.0), "alpha": np.array("premultiplied?")}, "alpha"),
        ({"rgba": GOOD, "reference_length": np.array(1.0), "size": np.array([1.0, 2.0])}, "size"),
    ],
)
def test_what_is_no_volume_is_refused_by_its_field(arrays: dict[str, np.ndarray], field: str, tmp_path: Path) -> None:
    with pytest.raises(AssetError) as refusal:
        load_volume(file_of(tmp_path, **arrays))
    assert refusal.value.field == field


def test_objects_are_never_unpickled(tmp_path: Path) -> None:
    class Trap:
        def __reduce__(self) -> tuple:
            return pytest.fail, ("unpickled",)

    path = tmp_path / "trap.npz"
    np.savez(path, rgba=np.array([Trap()], dtype=object), allow_pickle=True)
    with pytest.raises(AssetError, match=r"rgba.*Python objects"):
        load_volume(path)


def test_too_many_voxels_are_refused(tmp_path: Path) -> None:
    with pytest.raises(LimitError, match="rgba"):
        load_volume(file_of(tmp_path, rgba=GOOD), Limits(voxels=7), SAID)


def test_a_truncated_volume_is_refused(tmp_path: Path) -> None:
    data = file_of(tmp_path, rgba=GOOD).read_bytes()
    for tenth in range(10):
        (tmp_path / "cut.npz").write_bytes(data[: len(data) * tenth // 10])
        with pytest.raises(AssetError):
            load_volume(tmp_path / "cut.npz", reading=SAID)
