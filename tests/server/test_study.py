"""What a study left, over HTTP: its files, the catalogue of failures, the facts of the techniques."""

from __future__ import annotations

import functools
import json
import os
from pathlib import Path

import pytest
from starlette.testclient import TestClient

from renderer.failing import failures
from renderer.session import Session
from server.routes import study
from tests.server.fake_session import FakeSession


def test_a_study_serves_what_it_lists_and_nothing_else(client: TestClient, tmp_path: Path) -> None:
    assert client.get("/api/study/fake").status_code == 404
    folder = tmp_path / "study" / "fake" / "charts"
    folder.mkdir(parents=True)
    (folder / "front.svg").write_text("<svg/>")
    (tmp_path / "secret.json").write_text("{}")
    (folder / "link.json").symlink_to(tmp_path / "secret.json")
    listed = client.get("/api/study/fake").json()
    assert [entry["name"] for entry in listed] == ["charts/front.svg"]
    assert client.get(listed[0]["url"]).text == "<svg/>"
    for name in ("../../secret.json", "%2e%2e/%2e%2e/secret.json", "charts/link.json", "charts"):
        assert client.get(f"/api/study/fake/{name}").status_code == 404
    assert client.get("/api/study/..").status_code == 404


def test_a_study_is_the_projects_own_until_there_is_a_newer_one(
    client: TestClient, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(study, "KEPT", tmp_path / "kept")
    assert client.get("/api/study/fake/techniques").status_code == 404
    for home, age in (("kept", 100), ("study", 200)):
        path = tmp_path / home / "fake" / "techniques" / "facts.json"
        path.parent.mkdir(parents=True)
        path.write_text(json.dumps({"slots": {"shadow": {}}, "note": home}))
        os.utime(path, (age, age))
    assert client.get("/api/study/fake/techniques").json()["note"] == "study"
    os.utime(tmp_path / "kept" / "fake" / "techniques" / "facts.json", (300, 300))
    assert client.get("/api/study/fake/techniques").json()["note"] == "kept"
    assert [entry["name"] for entry in client.get("/api/study/fake").json()] == ["techniques/facts.json"]


def test_failures_are_listed_with_their_states_and_numbers(
    client: TestClient, session: FakeSession, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert client.get("/api/study/fake/failures").status_code == 404
    monkeypatch.setattr(session, "state", functools.partial(Session.state, session))
    monkeypatch.setattr(session, "validate", functools.partial(Session.validate, session))
    folder = tmp_path / "study" / "forest" / "failures"
    folder.mkdir(parents=True)
    (folder / "results.json").write_text(
        json.dumps([{"name": "depth_map_scintillates", "failing_now": 0.9, "surviving_now": 0.8}])
    )
    (folder / "depth_map_scintillates.jpg").write_bytes(b"picture")
    os.utime(folder / "results.json", (4e9, 4e9))
    os.utime(folder / "depth_map_scintillates.jpg", (4e9, 4e9))
    found = {case["name"]: case for case in client.get("/api/study/forest/failures").json()}
    assert set(found) == set(failures("forest"))
    case = found["depth_map_scintillates"]
    assert (case["failing_now"], case["surviving_now"], case["holds"]) == (0.9, 0.8, False)
    assert client.get(case["picture"]).content == b"picture"
    assert case["state"]["shadow"]["kind"] == "depth_shadow_map"
    assert case["patch"]["shadow"]["kind"] == "double_horizon_map"
    turned = [move["sun"]["azimuth"] - case["state"]["sun"]["azimuth"] for move in case["moves"]]
    assert turned == pytest.approx([0.25, 0.5, 0.75, 1.0])
    assert all(set(move) == {"sun"} for move in case["moves"])
