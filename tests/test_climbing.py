"""The climb to space: a camera that moves without a break, and a sheet that shows every picture."""

from __future__ import annotations

import math

import numpy as np
import pytest

from renderer import climbing
from renderer.clouds.world_scale import PLANET_RADIUS
from renderer.core.params import validate
from renderer.world.camera import Look, pose
from server import cli


def test_the_camera_is_as_high_as_it_says_and_ends_over_the_earths_middle() -> None:
    for height in climbing.heights(24):
        given = climbing.camera(height, 230.0)
        eye = np.array(given["eye"]) + (0.0, 0.0, PLANET_RADIUS)
        assert np.linalg.norm(eye) - PLANET_RADIUS == pytest.approx(height + 230.0, rel=1e-6)
    sight = pose(validate(Look, given)).forward
    assert sight @ eye / np.linalg.norm(eye) == pytest.approx(-1.0, abs=1e-6)


def test_the_sight_turns_without_a_jerk() -> None:
    """A thousandth more height turns it by less than a tenth of a degree, everywhere."""
    for height in np.geomspace(climbing.LOWEST, climbing.HIGHEST / 1.001, 400):
        first, second = (
            pose(validate(Look, climbing.camera(float(h), 230.0))).forward for h in (height, 1.001 * height)
        )
        assert math.degrees(math.acos(min(first @ second, 1.0))) < 0.1


def test_a_sheet_holds_its_pictures_in_rows() -> None:
    pictures = [np.full((40, 60, 3), 20 * number, np.uint8) for number in range(8)]
    found = np.asarray(climbing.sheet(pictures, [""] * 8))
    assert found.shape == (80, 6 * 60, 3)
    assert [int(found[60, 30 + 60 * column, 0]) for column in (0, 1)] == [120, 140]


def test_too_many_frames_are_refused_in_words(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["climb", "clouds", "--frames", "1"]) == 2
    assert "2 to 240" in capsys.readouterr().err
