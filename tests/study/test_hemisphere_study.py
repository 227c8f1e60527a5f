"""The study of shadow hemispheres: what it measures of a small cloud whose shadows are known, its table and charts."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from renderer import hemisphere_report as report
from renderer import hemisphere_study as study
from renderer.core.errors import InputError
from renderer.directional.frames import quantised
from renderer.directional.hemisphere import hemisphere_of
from renderer.directional.shadow_hemispheres import Caster, shadow_bits, unpacked
from server import cli


def cloud(points: int = 40) -> study.Cloud:
    """Points on level ground before a wall."""
    vertices = np.array([[1, -50, -1], [1, 50, -1], [1, 50, 1], [1, -50, 1], [0, 0, -2], [1, 0, -2], [0, 1, -2]], float)
    caster = Caster(vertices, np.array([[0, 1, 2], [0, 2, 3], [4, 5, 6]]))
    places = np.stack([np.linspace(-2, 0.9, points), np.zeros(points), np.zeros(points)], axis=1)
    return study.Cloud("wall", places, quantised(np.tile([0.0, 0.0, 1.0], (points, 1))), caster)


@pytest.fixture(scope="module")
def parts() -> dict[str, study.Lines]:
    """Of a cloud, and again as another's, as `measure` gives them."""
    found: dict[str, study.Lines] = {"codes": [], "between": [], "openness": [], "rays": []}
    one = cloud()
    for count in (129, 513):
        bits, openness = shadow_bits(one.caster, one.positions, one.normals, hemisphere_of(count), study.quiet)
        found["codes"] += study.code_lines(one, count, unpacked(bits, count), study.quiet)
        found["rays"].append({"cloud": one.name, "points": 40, "directions": count, "lit": 0.7,
                              "openness": float(openness.mean()), "us_a_point": 20.0})  # fmt: skip
    found["between"] = study.between_lines(one, study.quiet)
    found["openness"] = study.openness_lines(one)
    return {name: lines + [{**line, "cloud": "fence"} for line in lines] for name, lines in found.items()}


def test_codes_of_a_wall(parts: dict[str, study.Lines]) -> None:
    own = {(line["code"], line["bytes"]): line for line in parts["codes"] if line["directions"] == 129}
    for exact in (("bits", 17), ("exact_harmonics", 17), ("horizon_ring", 9), ("codebook", 9), ("chosen", 9)):
        assert own[exact]["misjudged"] == 0
    waves = [own["harmonics", size]["misjudged"] for size in (5, 9, 17, 33)]
    assert waves == sorted(waves, reverse=True)
    assert own["harmonics", 9]["overshoot"] > 0.1
    for name in ("cosines, fixed (L4)", "principal components"):
        assert own[name, 33]["rms"] < own[name, 5]["rms"] < 0.35


def test_finer_masks_miss_less(parts: dict[str, study.Lines]) -> None:
    own = {(line["directions"], line["read"]): line for line in parts["between"] if line["cloud"] == "wall"}
    for read in ("nearest", "blended"):
        wrong = [own[count, read]["misjudged"] for count in (33, 129, 513, 2049)]
        assert wrong == sorted(wrong, reverse=True)
    assert own[129, "blended"]["rms"] < own[129, "nearest"]["rms"]
    assert parts["openness"][1]["rms"] < 0.03


def test_table_and_charts(parts: dict[str, study.Lines], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(study, "measure", lambda mesh, points, tell: parts)
    text = report.run(tmp_path, None, 40, study.quiet)
    assert "| chosen | 9 | 0.00% |" in text
    assert {path.name for path in tmp_path.iterdir()} == set(report.FILES)
    lines = [json.loads(line) for line in (tmp_path / "results.jsonl").read_text().splitlines()]
    assert len(lines) == sum(map(len, parts.values()))


@pytest.mark.parametrize(
    "more",
    [["forest", "--hemispheres"], ["directional", "--hemispheres", "--points", "9"],
     ["directional", "--hemispheres", "--mesh", "nowhere.ply"]],
)  # fmt: skip
def test_what_cannot_be_studied_is_refused(more: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["study", *more]) != 0
    assert "--" in capsys.readouterr().err


def test_a_mesh_that_is_none_is_refused(tmp_path: Path) -> None:
    bad = tmp_path / "bad.ply"
    bad.write_bytes(b"no mesh")
    with pytest.raises(InputError) as refused:
        next(study.clouds(bad, 1000))
    assert refused.value.field.startswith("--mesh")
