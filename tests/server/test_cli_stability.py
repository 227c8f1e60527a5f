from __future__ import annotations

import json

import pytest

from server import cli


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("stability desert", "scene: there is no such scene"),
        ("stability forest --presets dawn", "--presets: dawn is not known"),
        ("stability forest --slot hat", "--slot: hat is not known"),
        ("stability forest --techniques hat", "techniques: shadow has no technique hat"),
        ("stability forest --width 4000", "width: 4000 px are not studied"),
        ("stability forest --set filter", "--set: filter is not understood"),
    ],
)
def test_a_wrong_option_is_named(command: str, words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(command.split()) == cli.REFUSED
    assert words in capsys.readouterr().err


def test_failures_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["failures", "forest"]) == 0
    told = capsys.readouterr().out
    assert "depth_map_scintillates: A shadow map scintillates while the sun moves" in told
    assert "low_sun, sun_azimuth moving: flicker above" in told
    assert cli.main(["failures", "forest", "--json"]) == 0
    assert {"name", "threshold", "cause"} <= set(json.loads(capsys.readouterr().out)[0])


def test_a_case_that_there_is_not_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["failures", "forest", "--measure", "sea_monsters"]) == cli.REFUSED
    assert "--measure: sea_monsters is not known" in capsys.readouterr().err
