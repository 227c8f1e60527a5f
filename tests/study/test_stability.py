"""Flicker: what changes though the truth does not, its chart and its strips."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from renderer.core.errors import InputError
from renderer.study.stability import changes, flicker, strip, table, write

RNG = np.random.default_rng(2)


def sweep(places: int = 5) -> np.ndarray:
    return RNG.uniform(0.5, 1.5, (places, 6, 8, 4))


def line(**changes: Any) -> dict[str, Any]:
    once = {"flicker": 0.3, "worst": 0.4}
    found = {"flicker": 0.1, "worst": 0.2, "once": once, "truth": 0.05, "reference_standard_error": 0.01,
             "size": [128, 72], "steps": 16}  # fmt: skip
    return {"preset": "noon", "sweep": "camera", "label": "map", **found, **changes}


def test_what_moves_with_the_truth_is_no_flicker() -> None:
    truths = sweep()
    still = RNG.uniform(0, 1, (6, 8, 4))  # an error that stays is none either
    found = flicker(list(truths + still), list(truths))
    assert found.value < 1e-12
    colours = truths[..., :3]
    assert found.truth == pytest.approx(np.sqrt((np.diff(colours, axis=0) ** 2).mean()) / colours.mean())


def test_flicker_is_the_root_mean_square_over_steps_pixels_and_channels() -> None:
    truths = np.full((4, 6, 8, 3), 2.0)
    pictures = truths.copy()
    pictures[1, 0, 0, 0] += 3.0  # one value of 144, there and back again: steps 0 and 1
    found = flicker(list(pictures), list(truths))
    assert found.steps == pytest.approx([1.5 / 12, 1.5 / 12, 0.0])
    assert found.value == pytest.approx(1.5 / 12 * np.sqrt(2 / 3))
    assert found.map[0, 0] == pytest.approx(1.5 / 3)
    assert np.abs(found.map).sum() == pytest.approx(0.5)
    found = flicker(list(pictures[[0, 2, 3, 1]]), list(truths))
    assert (found.worst_step, found.worst) == (2, pytest.approx(1.5 / 12))


def test_alpha_has_no_part() -> None:
    truths = sweep()
    pictures = truths.copy()
    pictures[..., 3] = RNG.uniform(0, 1, pictures.shape[:3])
    assert flicker(list(pictures), list(truths)).value == 0


@pytest.mark.parametrize(
    ("pictures", "references", "field"),
    [
        (sweep(1), sweep(1), "pictures"),
        (sweep(3), sweep(2), "pictures"),
        (sweep(2)[:, :3], sweep(2), "pictures"),
        (sweep(2), 0 * sweep(2), "references"),
    ],
)
def test_what_cannot_be_compared_is_refused(pictures: np.ndarray, references: np.ndarray, field: str) -> None:
    with pytest.raises(InputError) as refused:
        flicker(list(pictures), list(references))
    assert refused.value.field == field


def test_a_strip_shows_before_after_and_where_it_flickers() -> None:
    truths = np.full((2, 6, 8, 3), 1.0)
    pictures = truths.copy()
    pictures[1, 2, 3] += 1.0
    pictures[1, 4, 5] -= 1.0
    dark, bright = np.zeros((6, 8, 3), np.uint8), np.full((6, 8, 3), 200, np.uint8)
    found = strip(dark, bright, flicker(list(pictures), list(truths)), top=1.0)
    assert found.shape == (6 * 32, 24 * 32, 3)
    found = found[::32, ::32]
    assert (found[:, :8] == 0).all()
    assert (found[:, 8:16] == 200).all()
    red, blue = found[2, 16 + 3].astype(int), found[4, 16 + 5].astype(int)
    assert red[0] > red[2] + 50
    assert blue[2] > blue[0] + 50


def test_changes_share_one_scale() -> None:
    still = np.ones((2, 4, 6, 3))
    one, other = still.copy(), still.copy()
    one[1, :2] += 0.4
    other[1, :2] -= 0.2
    left, right = changes([flicker(one, still), flicker(other, still)], 12)
    assert left.shape == right.shape == (8, 12, 3)
    assert left[0, 0, 0] > left[0, 0, 2], "brighter is red"
    assert right[0, 0, 0] < right[0, 0, 2], "darker is blue"
    assert left[0, 0].sum() < right[0, 0].sum(), "and half as much is paler"
    np.testing.assert_array_equal(left[-1, -1], right[-1, -1])


def test_the_steadiest_comes_first_and_everything_is_written(tmp_path: Path) -> None:
    lines = [line(), line(label="steady", flicker=0.02), line(sweep="sun_azimuth", label="steady", flicker=0.3)]
    rows = table(lines).splitlines()[2:]
    assert [row.split(" | ")[2] for row in rows] == ["steady", "map", "steady"]
    assert "0.0200" in rows[0]
    assert all(row.endswith("| 128 x 72, 16 |") for row in rows), "each tells its own size"
    write(lines, tmp_path, "a title")
    assert (tmp_path / "table.md").read_text().startswith("a title\n")
    assert (tmp_path / "flicker.png").stat().st_size > 5000
    svg = (tmp_path / "flicker.svg").read_text()
    write(lines, tmp_path, "a title")
    assert len((tmp_path / "flicker.svg").read_text()) == len(svg)
