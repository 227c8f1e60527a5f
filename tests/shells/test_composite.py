"""The quantity `composite`, at every door."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from starlette.testclient import TestClient

from renderer.core.errors import AssetError, InputError, InvalidDocument, LimitError
from renderer.session import Session
from renderer.study import measure as door
from server import cli
from server.app import create_app
from server.settings import Settings
from tests.server.fake_session import FakeSession

FILE = Path(__file__).parents[1] / "references" / "shells" / "prisms.json"
SHARED = json.loads(FILE.read_text())
SETS = tuple(SHARED["sets"])

SQUARE = [[[-9, -9], [9, -9], [9, 9]], [[-9, -9], [9, 9], [-9, 9]]]
DOWN = {"o": [0.5, 0.2, 5], "d": [0, 0, -2]}


def right(name: str) -> dict[str, np.ndarray]:
    rays = SHARED["sets"][name]["rays"]
    return {key: np.array([ray[key] for ray in rays]) for key in ("intervals", "front_to_back", "rgb", "alpha")}


def layer(low: float, high: float, sigma: float, color: Any) -> list[dict[str, Any]]:
    """A level layer: two prisms."""
    return [{"vertices": [[*xy, z] for z in (low, high) for xy in corner], "sigma": sigma, "color": color}
            for corner in SQUARE]  # fmt: skip


def found(prisms: Any, rays: Any = (DOWN,), **arguments: Any) -> Mapping[str, np.ndarray]:
    return door.measure("composite", {"prisms": prisms, "rays": list(rays), **arguments}).arrays


def agrees(answer: Mapping[str, Any], name: str) -> None:
    for key, values in right(name).items():
        assert np.array(answer[key]) == pytest.approx(values, rel=1e-13, abs=1e-14), key


@pytest.mark.parametrize("name", SETS)
def test_the_command_line_knows_the_shared_prisms(name: str, tmp_path: Path) -> None:
    out = tmp_path / "out.json"
    assert cli.main(["measure", "composite", "--prisms", str(FILE), "--set", name, "-o", str(out)]) == 0
    answer = json.loads(out.read_text())
    agrees(answer, name)
    assert {"technique", "estimated_error", "units", "source"} <= set(answer["meta"])


@pytest.fixture
def web(tmp_path: Path) -> Iterator[TestClient]:
    class Measuring(FakeSession):
        quantities = staticmethod(Session.quantities)
        measure = staticmethod(Session.measure)

    session = Measuring(tmp_path)
    with TestClient(create_app(session, Settings(study=str(tmp_path))), base_url="http://127.0.0.1:8000") as client:
        yield client
    session.close()


def test_rest_knows_them_as_they_stand_in_the_file(web: TestClient) -> None:
    for name in SETS:
        answer = web.post("/api/measure/composite", json={"materials": SHARED["materials"], **SHARED["sets"][name]})
        assert answer.status_code == 200, answer.text
        agrees(answer.json(), name)
    refused = web.post("/api/measure/composite", json={"prisms": SHARED["sets"][SETS[0]]["prisms"], "rays": [DOWN]})
    assert (refused.status_code, refused.json()["errors"][0]["field"]) == (422, "prisms.0")


def test_layers_in_closed_form_and_their_order() -> None:
    """Two coloured layers (errata 002-3): nearest first."""
    prisms = [*layer(0, 1, 0.7, [1, 0, 0]), *layer(2, 3, 1.1, [0, 1, 0])]
    seen = found(prisms)
    upper, lower = np.exp(-1.1), np.exp(-0.7)
    assert seen["rgb"][0] == pytest.approx([upper * (1 - lower), 1 - upper, 0])
    assert seen["alpha"][0] == pytest.approx(1 - upper * lower)
    assert seen["intervals"][0] == pytest.approx(np.array([[4, 5], [np.nan] * 2, [2, 3], [np.nan] * 2]), nan_ok=True)
    assert seen["front_to_back"][0].tolist() == [2, 0, -1, -1]
    inside = found(prisms, [{"o": [0.5, 0.2, 2.5], "d": [0, 0, -1]}])
    assert inside["intervals"][0, 2] == pytest.approx([0, 0.5])
    nothing = found(prisms, [{"o": [50, 0, 5], "d": [0, 0, -1]}, {"o": [0.5, 0.2, -5], "d": [0, 0, -1]}])
    assert np.abs(nothing["rgb"]).max() == nothing["alpha"].max() == 0
    assert (nothing["front_to_back"] == -1).all()


def test_a_prism_with_a_bent_side_is_its_three_tetrahedra() -> None:
    """Volumes add up: the mean path through a twisted prism, by rays on a lattice, is its volume over their area."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [0.2, 0.9, 0], [0.1, 0.3, 0.8], [1.1, 0.2, 1.2], [0.5, 1.1, 0.7]])
    tets = corners[[[0, 1, 2, 5], [0, 1, 4, 5], [0, 3, 4, 5]]]
    volume = np.abs(np.linalg.det(tets[:, 1:] - tets[:, :1])).sum() / 6
    x, y = (a.ravel() * 0.02 - 0.31 for a in np.mgrid[0:80, 0:80])
    rays = [{"o": [a, b, -1], "d": [0, 0, 1]} for a, b in zip(x, y)]
    prism = {"vertices": corners.tolist(), "sigma": 1e-6, "color": [1, 1, 1]}
    assert found([prism], rays)["alpha"].sum() / 1e-6 * 0.02**2 == pytest.approx(volume, rel=5e-3)


@pytest.mark.parametrize("technique", ["segments", "march"])
def test_opacity_is_independent_of_the_steps_where_it_is_corrected(technique: str) -> None:
    prisms = layer(0, 1, 2.0, [0.5, 0.5, 0.5])
    for steps in (1, 7, 64):
        assert found(prisms, technique=technique, steps=steps)["alpha"][0] == pytest.approx(1 - np.exp(-2))
    few, many = (-np.log(1 - found(prisms, technique=technique, steps=steps, opacity_correction=False)["alpha"][0])
                 for steps in (3, 12))  # fmt: skip
    cells = round(few / 0.6)
    assert 1 <= cells <= (1 if technique == "march" else 3)
    assert (few, many) == pytest.approx((0.6 * cells, 2.4 * cells))


def test_the_printed_sum_forgets_to_weight_colour() -> None:
    """c = 0.5, optical depth 2, 64 steps: 0.43233, and 14.05 as printed (errata 002-1)."""
    prisms = layer(0, 1, 2.0, [0.5, 0.5, 0.5])
    assert found(prisms)["rgb"][0, 0] == pytest.approx(0.43233, abs=5e-6)
    assert found(prisms, technique="march", steps=64)["rgb"][0, 0] == pytest.approx(0.43233, abs=5e-6)
    printed = found(prisms, technique="march", steps=64, premultiplied=False)
    assert printed["rgb"][0, 0] == pytest.approx(14.05, abs=0.01)
    assert printed["rgb_error"][0, 0] == pytest.approx(printed["rgb"][0, 0] - 0.5 * (1 - np.exp(-2)))
    assert found(prisms, technique="segments", steps=64, premultiplied=False)["rgb"][0, 0] > 14


@pytest.mark.parametrize(("name", "expected"), [("disjoint", 1e-13), ("overlapping", 0.15)])
def test_segments_by_entry_are_right_only_where_nothing_overlaps(name: str, expected: float) -> None:
    given = {"materials": SHARED["materials"], **SHARED["sets"][name]}
    seen = door.measure("composite", {**given, "technique": "segments"})
    worst = np.abs(seen.arrays["rgb"] - right(name)["rgb"]).max()
    assert expected / 10 < worst < expected if expected > 1e-3 else worst < expected
    assert np.abs(seen.arrays["rgb_error"]).max() == pytest.approx(worst, abs=1e-13)
    steps = [np.abs(door.measure("composite", {**given, "technique": "march", "steps": n}).arrays["rgb_error"]).max()
             for n in (16, 1024)]  # fmt: skip
    assert steps[1] < 0.05 * steps[0]
    assert steps[1] < 2e-3


def test_files_of_their_own_and_what_they_may_not_be(tmp_path: Path) -> None:
    one = SHARED["sets"]["disjoint"]
    prisms, rays, bad = tmp_path / "prisms.json", tmp_path / "rays.json", tmp_path / "bad.json"
    prisms.write_text(json.dumps({"materials": SHARED["materials"], "prisms": one["prisms"]}))
    rays.write_text(json.dumps(one["rays"]))
    agrees(door.measure("composite", {}, {"prisms": prisms, "rays": rays}).arrays, "disjoint")
    agrees(door.measure("composite", {"set": "disjoint"}, {"prisms": FILE, "rays": FILE}).arrays, "disjoint")
    few = door.measure("composite", {"set": "disjoint", "rays": [DOWN]}, {"prisms": FILE})
    assert len(few.arrays["alpha"]) == 1
    with pytest.raises(InputError, match="set") as refused:
        door.measure("composite", {}, {"prisms": FILE})
    assert refused.value.allowed == "disjoint, overlapping"
    with pytest.raises(InputError, match="rays: are given both"):
        door.measure("composite", {"rays": [DOWN]}, {"prisms": prisms, "rays": rays})
    for text, words in (("{", "no JSON"), ("3", "no list"), ("[" * 100_000, "no JSON"), ("\xff", "rays")):
        bad.write_text(text, encoding="latin-1")
        with pytest.raises((AssetError, InputError), match=words):
            door.measure("composite", {"prisms": one["prisms"]}, {"rays": bad})
    bad.write_text('[{"o": [0, 0, 0], "d": [0, "x", 1]}]')
    with pytest.raises(InvalidDocument, match="rays"):
        door.measure("composite", {"prisms": one["prisms"]}, {"rays": bad})


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"rays": []}, "rays: none"),
        ({"prisms": []}, "prisms: none"),
        ({"rays": [{"o": [0, 0, 0], "d": [0, 0, 0]}]}, "rays.0.d"),
        ({"prisms": [{"vertices": SHARED["sets"]["disjoint"]["prisms"][0]["vertices"], "material": 7}]}, "prisms.0"),
    ],
)
def test_what_is_missing_is_named(change: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        door.measure("composite", {"prisms": layer(0, 1, 1, [1, 1, 1]), "rays": [DOWN], **change})


def test_too_much_is_refused_before_it_is_begun() -> None:
    with pytest.raises(LimitError, match="rays"):
        found(layer(0, 1, 1, [1, 1, 1]) * 300, [DOWN] * 300, technique="march", steps=100_000)
