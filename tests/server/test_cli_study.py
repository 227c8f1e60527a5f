from __future__ import annotations

import numpy as np
import pytest

from server import bench, cli, cli_study

EVERY = ("noon", "low_sun", "sunset")


@pytest.mark.parametrize(
    ("text", "names"), [("all", EVERY), ("2", EVERY[:2]), ("sunset,noon", ("sunset", "noon")), ("", ())]
)
def test_names_are_listed_counted_or_all(text: str, names: tuple[str, ...]) -> None:
    assert cli_study.names_of("--presets", text, EVERY) == names


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("study forest --presets dawn", "--presets: dawn is not known"),
        ("study forest --suns 99", "--suns: 99 is not known"),
        ("study forest --slots shadow,hat", "--slots: hat is not known"),
        ("study forest --size 4000", "size: 4000 px are not studied"),
        ("study forest --frames -1", "--frames: cannot be negative"),
        ("study desert", "scene: there is no such scene"),
        ("bench forest --parts everything", "--parts: everything is not known"),
        ("bench forest --frames 0", "--frames: must be at least one"),
    ],
)
def test_a_wrong_option_is_named(command: str, words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(command.split()) == cli.REFUSED
    assert words in capsys.readouterr().err


def test_encoding_is_told_for_every_form_of_frame() -> None:
    noise = np.random.default_rng(1).integers(0, 256, (64, 96, 3), np.uint8)
    lines = bench.encoding(noise)
    assert [line["codec"] for line in lines] == ["jpeg", "jpeg", "png"]
    assert lines[0]["bytes"] < lines[1]["bytes"] < lines[2]["bytes"]
    assert {tuple(line["size"]) for line in lines} == {(96, 64)}


def test_a_picture_is_made_small_enough() -> None:
    noise = np.random.default_rng(1).integers(0, 256, (64, 96, 3), np.uint8)
    best = bench.small_jpeg(noise, 10**6)
    limit = len(best) * 2 // 3
    assert len(bench.small_jpeg(noise, limit)) <= limit
