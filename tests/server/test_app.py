from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import pytest
from starlette.testclient import TestClient

from server.app import create_app
from server.settings import Settings
from tests.server.fake_session import FakeSession


def until(condition: Any) -> None:
    deadline = time.monotonic() + 5
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.01)


def test_a_warm_server_draws_before_anybody_asks(session: FakeSession) -> None:
    with TestClient(create_app(session, Settings(), warm=True)):
        until(lambda: session.renders == 1)
        assert len(session.preparations) == 1


def test_a_server_that_cannot_warm_up_serves(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    session = FakeSession(tmp_path)
    monkeypatch.setattr(session, "state", lambda *_: session._known("nothing"))
    with TestClient(create_app(session, Settings(hosts="testserver"), warm=True)) as client:
        until(lambda: "not ready" in caplog.text)
        assert client.get("/api/health").status_code == 200
    session.close()


@pytest.mark.parametrize("started", [False, True])
def test_a_warm_up_ends_with_the_server(session: FakeSession, started: bool) -> None:
    session.baked.clear()
    session.bake_gate.clear()
    if not started:
        session.start_gate.clear()
    with TestClient(create_app(session, Settings(), warm=True)):
        until(lambda: session.preparations)
    session.start_gate.set()
    until(lambda: session.preparations[0].cancelled)
    assert session.renders == 0
