from __future__ import annotations

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
