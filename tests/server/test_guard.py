from __future__ import annotations

from typing import Any

import pytest
from starlette.testclient import TestClient
from starlette.websockets import WebSocketDisconnect

from renderer.core.errors import InputError
from server.app import create_app
from server.settings import Settings, load
from tests.server.fake_session import FakeSession


def served(session: FakeSession, base: str = "http://127.0.0.1:8000", **settings: Any) -> TestClient:
    return TestClient(create_app(session, Settings(**settings)), base_url=base, raise_server_exceptions=False)


@pytest.mark.parametrize("host", ["evil.example", "127.0.0.1.evil.example", "evil.example:8000", ""])
def test_another_name_for_a_loopback_server_is_refused(session: FakeSession, host: str) -> None:
    with served(session) as client:
        assert client.get("/api/scenes", headers={"Host": host}).status_code == 421
        for good in ("127.0.0.1:8000", "localhost:9", "[::1]:8000"):
            assert client.get("/api/scenes", headers={"Host": good}).status_code == 200


def test_pages_of_another_origin_may_not_write_or_stream(session: FakeSession) -> None:
    with served(session, hosts="testserver", origins="https://notebook.example") as client:
        body = {"scene": "fake", "width": 8, "height": 8, "quality": {"kind": "draft"}}
        for origin, status in [("http://evil.example", 403), ("null", 403), ("http://[", 403),
                               ("http://127.0.0.1:8000", 200), ("https://notebook.example", 200)]:  # fmt: skip
            assert client.post("/api/render", json=body, headers={"Origin": origin}).status_code == status
        with (
            pytest.raises(WebSocketDisconnect) as refused,
            client.websocket_connect("/api/session", headers={"Origin": "http://evil.example"}),
        ):
            pass
        assert "another origin" in refused.value.reason


def test_a_public_server_asks_for_its_token(session: FakeSession) -> None:
    with served(session, base="http://umbrage.example", host="0.0.0.0", token="a-secret") as client:
        refused = client.get("/api/scenes")
        assert refused.status_code == 401
        assert refused.json()["errors"][0]["field"] == "token"
        assert "a-secret" not in refused.text
        assert client.get("/api/scenes?token=wrong").status_code == 401
        assert client.get("/api/scenes", headers={"Authorization": "Bearer a-secret"}).status_code == 200
        assert client.get("/api/health").status_code == 200
        with pytest.raises(WebSocketDisconnect), client.websocket_connect("ws://umbrage.example/api/session"):
            pass
        page = client.get("/?token=a-secret")
        assert "HttpOnly" in page.headers["set-cookie"]
        assert client.get("/api/scenes").status_code == 200, "the page's own requests carry the cookie"
        with client.websocket_connect("ws://umbrage.example/api/session") as socket:
            socket.send_text('{"type":"ping","id":1}')
            assert "pong" in socket.receive_text()


def test_a_token_is_made_where_the_address_is_public() -> None:
    assert len(Settings(host="0.0.0.0").secured().token) > 20
    assert Settings(host="0.0.0.0", token="mine").secured().token == "mine"
    assert Settings(host="127.0.0.1").secured().token == ""


def test_settings_come_from_the_environment_and_name_what_is_wrong() -> None:
    assert load({"UMBRAGE_PORT": "9", "UMBRAGE_CACHE": "/x"}).port == 9
    assert load({"UMBRAGE_PORT": "9"}, port=10, host=None).port == 10
    with pytest.raises(InputError) as wrong:
        load({"UMBRAGE_MAX_SIDE": "huge"})
    assert wrong.value.field == "UMBRAGE_MAX_SIDE"
    with pytest.raises(InputError) as low:
        load({"UMBRAGE_SESSIONS": "0"})
    assert "at least 1" in low.value.allowed
