"""Bad input on the socket: an answer that names the field, and a session that goes on."""

from __future__ import annotations

import json
import time
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from starlette.testclient import TestClient

from server.protocol import CLIENT
from tests.server.fake_session import FakeSession
from tests.server.talk import Talk


@pytest.mark.parametrize(
    ("message", "field", "allowed"),
    [
        ({"type": "close"}, "type", "hello"),
        ({"type": ["patch"]}, "type", "hello"),
        ({}, "type", "hello"),
        ({"type": "patch", "patch": {"brightness": 2}, "id": 1}, "brightness", "at most 1"),
        ({"type": "patch", "patch": {"brightness": "much"}, "id": 1}, "brightness", ""),
        ({"type": "patch", "patch": {"shadow": {"kind": "none"}}, "id": 1}, "shadow", ""),
        ({"type": "patch", "patch": {"camera": {"kind": "walrus"}}, "id": 1}, "camera.kind", "orbit"),
        ({"type": "patch", "patch": [1], "id": 1}, "patch", ""),
        ({"type": "patch", "patch": {}, "id": -1}, "id", ""),
        ({"type": "state", "state": {"scene": "atlantis"}, "id": 1}, "scene", "fake"),
        ({"type": "state", "state": {}, "id": 1}, "scene", "fake"),
        ({"type": "resize", "width": 0, "height": 5}, "width", ""),
        ({"type": "resize", "width": 5000, "height": 5}, "width", "4096"),
        ({"type": "resize", "width": 4000, "height": 4000}, "width", "8294400"),
        ({"type": "probe", "id": 1, "x": 2, "y": 0}, "x", ""),
        ({"type": "ack", "sequence": "x"}, "sequence", ""),
        ({"type": "moving"}, "active", ""),
        ({"type": "compare", "patch": {"brightness": -1}}, "brightness", "at least 0"),
        ({"type": "hello", "protocol": 1, "width": 9, "height": 9}, "type", "patch"),
    ],
)
def test_a_refusal_names_the_field_and_the_session_goes_on(
    client: TestClient, hello: dict[str, Any], message: dict[str, Any], field: str, allowed: str
) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = Talk(socket)
        talk.send(**hello)
        talk.until("idle")
        talk.send(**message)
        refused = talk.until("error")
        assert refused["field"] == field
        assert allowed in refused["allowed"]
        assert refused["message"]
        number = message.get("id")
        if number == 1 and field not in ("patch", "id", "x"):
            assert refused["id"] == 1
        talk.send(type="patch", patch={"brightness": 0.7}, id=2)
        assert talk.until("state")["version"] == 2, "what was refused changed nothing"


@pytest.mark.parametrize(
    "text",
    ["", "{", "[1, 2]", "null", '"hello"', '{"type": "patch", "patch": {"brightness": NaN}}', "[" * 100_000, "1" * 5000,
     '{"type":"patch","patch":{"brightness":1e999},"id":1}', '{"type":"patch","patch":{"\\ud800":1},"id":1}'],
)  # fmt: skip
def test_what_is_no_message_is_refused(client: TestClient, hello: dict[str, Any], text: str) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = Talk(socket)
        talk.send(**hello)
        talk.until("idle")
        socket.send_text(text)
        assert talk.until("error")["message"]
        assert talk.silent(0.0)


def test_binary_messages_are_refused(client: TestClient, hello: dict[str, Any]) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = Talk(socket)
        socket.send_bytes(bytes(range(200)))
        assert "binary" in talk.until("error")["message"]
        talk.send(**hello)
        talk.until("idle")


def test_nothing_but_hello_and_ping_is_understood_first(client: TestClient) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = Talk(socket)
        for message in ({"type": "patch", "patch": {}}, {"type": "ack", "sequence": 1}, {"type": "cancel"}):
            talk.send(**message)
            assert talk.until("error")["allowed"] == "hello, ping"
        talk.send(type="ping", id=3)
        assert talk.until("pong")["id"] == 3


@pytest.mark.parametrize(
    ("change", "field"),
    [({"width": 7000, "height": 7000}, "width"), ({"width": -3}, "width"), ({"codecs": ["walrus"]}, "codecs"),
     ({"frame_ms": 0}, "frame_ms"), ({"state": "x"}, "state")],
)  # fmt: skip
def test_a_wrong_hello_may_be_corrected(
    client: TestClient, hello: dict[str, Any], change: dict[str, Any], field: str
) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = Talk(socket)
        talk.send(**{**hello, **change})
        assert talk.until("error")["field"] == field
        talk.send(**hello)
        talk.until("welcome")


def test_another_protocol_is_closed_with_a_reason(client: TestClient, hello: dict[str, Any]) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = Talk(socket)
        talk.send(**{**hello, "protocol": 2})
        assert talk.until("error")["field"] == "protocol"
        closed = talk.next()
        assert isinstance(closed, dict)
        assert (closed["type"], closed["code"]) == ("closed", 4400)
        assert "protocol 1" in closed["reason"]


@pytest.mark.parametrize(
    "change", [{"state": {"scene": "fake", "brightness": 7}}, {"scene": "atlantis"}, {"preset": "x"}]
)
def test_a_hello_with_a_wrong_state_is_told_and_opens_the_default(
    client: TestClient, hello: dict[str, Any], change: dict[str, Any]
) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = Talk(socket)
        talk.send(**{**hello, **change})
        assert talk.until("error")["field"] in ("brightness", "scene", "preset")
        assert talk.until("welcome")["state"]["brightness"] == 0.75, "its first preset"
        talk.until("idle")


def test_a_flood_is_told_once_and_the_newest_state_still_comes(client: TestClient, hello: dict[str, Any]) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = Talk(socket)
        talk.send(**{**hello, "state": {"scene": "fake", "quality": {"kind": "draft"}}})
        talk.until("idle")
        for number in range(1000):
            talk.send(type="patch", patch={"brightness": 0.5 + number / 4000}, id=number)
        assert "100 a second" in talk.until("error", 2000)["allowed"]
        talk.until("idle", 2000)
        assert sum(message["type"] == "error" for message in talk.messages) <= 3
        assert len(talk.frames) < 200


def test_a_failing_program_is_told_with_file_and_line_and_the_session_goes_on(
    client: TestClient, hello: dict[str, Any]
) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = Talk(socket)
        talk.send(**hello)
        talk.until("idle")
        talk.send(type="patch", patch={"brightness": 0.25}, id=1)
        assert talk.until("error")["message"] == "fake/broken.glsl:7: syntax error"
        talk.send(type="patch", patch={"brightness": 0.125}, id=2)
        assert "secret" not in talk.until("error")["message"]
        talk.send(type="patch", patch={"brightness": 0.6}, id=3)
        assert talk.until("idle")["samples"] == 64


def test_more_sessions_than_allowed_are_closed_with_a_reason(client: TestClient) -> None:
    sockets = [client.websocket_connect("/api/session") for _ in range(4)]
    for socket in sockets:
        socket.__enter__()
        socket.send_text('{"type":"ping","id":1}')
        socket.receive_text()
    with client.websocket_connect("/api/session") as fifth:
        closed = fifth.receive()
        assert (closed["type"], closed["code"]) == ("websocket.close", 1013)
        assert "4 live views" in closed["reason"]
    for socket in sockets:
        socket.__exit__(None, None, None)


def test_a_client_that_leaves_in_the_middle_of_a_frame_harms_nobody(
    client: TestClient, session: FakeSession, hello: dict[str, Any]
) -> None:
    session.gate.clear()
    with client.websocket_connect("/api/session") as socket:
        Talk(socket).send(**hello)
        assert session.drawing.wait(5)
    session.gate.set()
    with client.websocket_connect("/api/session") as socket:
        talk = Talk(socket)
        talk.send(**hello)
        talk.until("idle")
    deadline = time.monotonic() + 5
    while client.get("/api/health").json()["sessions"] or not all(view.closed for view in session.views):
        assert time.monotonic() < deadline, "a session or a view was left open"
        time.sleep(0.01)


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner, max_size=3),
    max_leaves=8,
)
FIELDS = [
    "id",
    "patch",
    "state",
    "width",
    "height",
    "sequence",
    "x",
    "y",
    "active",
    "protocol",
    "codecs",
    "brightness",
    "kind",
]
MESSAGES = st.builds(
    lambda kind, fields: {"type": kind, **fields},
    st.sampled_from([*CLIENT, "close", "walrus"]),
    st.dictionaries(st.sampled_from(FIELDS), JSON, max_size=4),
)


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(messages=st.lists(MESSAGES | JSON, max_size=6), open_first=st.booleans())
def test_random_messages_never_end_a_session(
    client: TestClient, hello: dict[str, Any], messages: list[Any], open_first: bool
) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = Talk(socket)
        if open_first:
            talk.send(**{**hello, "state": {"scene": "fake", "quality": {"kind": "draft"}}})
            talk.until("idle")
        for message in messages:
            wrong_protocol = isinstance(message, dict) and message.get("type") == "hello"
            if not wrong_protocol:
                socket.send_text(json.dumps(message))
        talk.send(type="ping", id=77)
        while talk.until("pong")["id"] != 77:
            pass
