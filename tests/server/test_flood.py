"""Floods: answered within bounds, and never at the cost of those who wait their turn."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest
import uvicorn
from starlette.testclient import TestClient

from server.hub import Hub
from server.settings import Settings
from server.sockets import READ_BYTES
from server.stream import Stream
from tests.server.fake_session import FakeSession
from tests.server.talk import Talk
from tests.server.test_wire import idle, opened, running


@pytest.mark.parametrize("text", ["x", '{"type": "walrus"}', '{"type": "resize", "width": "wide"}'])
def test_what_is_no_message_counts_as_one(client: TestClient, hello: dict[str, Any], text: str) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = Talk(socket)
        talk.send(**{**hello, "state": {"scene": "fake", "quality": {"kind": "draft"}}})
        talk.until("idle")
        for _ in range(1000):
            socket.send_text(text)
        told = talk.until("error", 2000)
        while "too many" not in told["message"]:
            told = talk.until("error", 2000)
        while (found := talk.next()) != {"type": "pong", "id": 7}:
            assert isinstance(found, dict)
            talk.send(type="ping", id=7)
        assert sum(message["type"] == "error" for message in talk.messages) < 900


@pytest.mark.parametrize("number", ["NaN", "Infinity", "-Infinity"])
def test_the_parameter_that_holds_no_number_is_named(client: TestClient, hello: dict[str, Any], number: str) -> None:
    with client.websocket_connect("/api/session") as socket:
        talk = Talk(socket)
        talk.send(**hello)
        talk.until("idle")
        socket.send_text(f'{{"type": "patch", "patch": {{"brightness": {number}}}, "id": 1}}')
        refused = talk.until("error")
        assert (refused["field"], refused["id"]) == ("brightness", 1)
        assert "finite" in refused["message"]


@pytest.mark.parametrize("text", ['{"type": "ack", "sequence": 1}', '{"type": "ping", "id": 1}', "x"])
async def test_others_have_their_turn_after_every_message(session: FakeSession, text: str) -> None:
    """A socket that always has a message never makes its reader wait."""
    turns, left = 0, 300

    class Full:
        async def receive(self) -> dict[str, Any]:
            nonlocal left
            left -= 1
            return {"type": "websocket.receive", "text": text} if left else {"type": "websocket.disconnect"}

        async def send_text(self, text: str) -> None:
            """A client that takes everything."""

    async def other() -> None:
        nonlocal turns
        while True:
            turns += 1
            await asyncio.sleep(0)

    hub = Hub(session, Settings())
    waiting = asyncio.create_task(other())
    await Stream(Full(), hub).run()  # type: ignore[arg-type]
    waiting.cancel()
    await hub.close()
    assert turns > 290


def test_little_is_taken_from_a_socket_at_once(session: FakeSession) -> None:
    """Born from a flood of the shortest messages, of which asyncio took a second's worth in one piece."""

    async def taken(port: int, server: uvicorn.Server) -> list[int]:
        client = await opened(port)
        await idle(client)
        sizes = [connection.transport.max_size for connection in server.server_state.connections]
        await client.close()
        return sizes

    with running(session) as (port, server):
        assert asyncio.run(taken(port, server)) == [READ_BYTES]
