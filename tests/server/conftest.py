from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from starlette.testclient import TestClient

from server.app import create_app
from server.settings import Settings
from tests.server.fake_session import FakeSession


@pytest.fixture
def session(tmp_path: Path) -> Iterator[FakeSession]:
    fake = FakeSession(tmp_path)
    yield fake
    fake.gate.set()
    fake.bake_gate.set()
    fake.close()


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    return Settings(
        study=str(tmp_path / "study"),
        message_rate=100,
        upload_bytes=4096,
        hosts="testserver",
        body_bytes=65536,
        sessions=4,
    )


@pytest.fixture
def client(session: FakeSession, settings: Settings) -> Iterator[TestClient]:
    with TestClient(
        create_app(session, settings), base_url="http://127.0.0.1:8000", raise_server_exceptions=False
    ) as client:
        yield client


@pytest.fixture
def hello() -> dict[str, Any]:
    return {
        "type": "hello",
        "protocol": 1,
        "width": 64,
        "height": 48,
        "state": None,
        "scene": "fake",
        "preset": None,
        "codecs": ["jpeg", "png"],
        "frame_ms": 28,
    }
