"""The server on a real socket: what the test client cannot show."""

from __future__ import annotations

import asyncio
import contextlib
import json
import random
import socket
import struct
import threading
import time
from collections.abc import Iterator
from typing import Any

import httpx2
import pytest
import uvicorn
import websockets

from renderer.core.errors import InputError
from server.app import create_app
from server.cli_serve import address, configure
from server.protocol import unpack
from server.settings import Settings
from server.sockets import bind
from tests.server.fake_session import FakeSession


@contextlib.contextmanager
def running(session: FakeSession, **settings: Any) -> Iterator[tuple[int, uvicorn.Server]]:
    """A server on a free port, and its port."""
    chosen = Settings(port=0, **settings)
    config = configure(create_app(session, chosen), chosen)
    listener = bind(chosen)
    server = uvicorn.Server(config)
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]})
    thread.start()
    try:
        while not server.started:
            time.sleep(0.01)
        yield listener.getsockname()[1], server
    finally:
        server.should_exit = True
        thread.join(15)
        listener.close()
        assert not thread.is_alive(), "the server did not stop"


async def opened(port: int, **change: Any) -> Any:
    """A greeted client."""
    client = await websockets.connect(f"ws://127.0.0.1:{port}/api/session", max_size=None)
    hello = {"type": "hello", "protocol": 1, "width": 64, "height": 64, "scene": "fake", "frame_ms": 28, **change}
    await client.send(json.dumps(hello))
    return client


async def idle(client: Any) -> list[Any]:
    """Read, acknowledging, until the server falls silent; the frames' headers."""
    headers = []
    while True:
        message = await asyncio.wait_for(client.recv(), 10)
        if isinstance(message, bytes):
            headers.append(unpack(message)[0])
            await client.send(json.dumps({"type": "ack", "sequence": headers[-1].sequence}))
        elif json.loads(message)["type"] == "idle":
            return headers


def test_messages_are_not_compressed_again(session: FakeSession) -> None:
    async def talk(port: int) -> Any:
        client = await opened(port)
        await idle(client)
        extensions = client.protocol.extensions
        await client.close()
        return extensions

    with running(session) as (port, _):
        assert asyncio.run(talk(port)) == []


def test_small_messages_are_sent_at_once(session: FakeSession) -> None:
    """Born from 40 ms of latency: a frame waited for the acknowledgement of the message before it."""

    async def option(port: int, server: uvicorn.Server) -> list[int]:
        client = await opened(port)
        await idle(client)
        sockets = [connection.transport.get_extra_info("socket") for connection in server.server_state.connections]
        options = [found.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY) for found in sockets]
        await client.close()
        return options

    with running(session) as (port, server):
        assert asyncio.run(option(port, server)) == [1]


def test_a_port_in_use_is_said() -> None:
    with bind(Settings(port=0)) as taken:
        taken.listen()
        with pytest.raises(InputError) as refused:
            bind(Settings(port=taken.getsockname()[1]))
        assert refused.value.field == "port"


def handshake(port: int) -> socket.socket:
    raw = socket.create_connection(("127.0.0.1", port), timeout=10)
    raw.sendall(
        f"GET /api/session HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n".encode()
    )
    assert b"101" in raw.recv(4096)
    return raw


@pytest.mark.parametrize(
    "attack",
    [
        struct.pack("!BBQ", 0x81, 0xFF, 2 << 30) + b"mask" + b"x" * 100,  # a frame that claims 2 GB
        struct.pack("!BBQ", 0x81, 0xFF, 1 << 62) + b"mask",
        bytes(range(56, 256)),  # no WebSocket frames at all
        b"\x81\xfe\x00\x05mask\xff\xfe\xfd\xfc\xfb",  # text that is not UTF-8
    ],
)
def test_a_broken_frame_costs_its_sender_the_connection_and_nobody_else(session: FakeSession, attack: bytes) -> None:
    async def other(port: int) -> None:
        client = await opened(port)
        await idle(client)
        raw = await asyncio.to_thread(handshake, port)
        raw.sendall(attack)
        raw.shutdown(socket.SHUT_WR)
        while await asyncio.to_thread(raw.recv, 4096):
            pass
        raw.close()
        await client.send(json.dumps({"type": "patch", "patch": {"brightness": 0.9}, "id": 1}))
        assert (await idle(client))[-1].version == 2
        await client.close()

    with running(session) as (port, _):
        asyncio.run(other(port))


def test_random_bytes_and_broken_requests_on_the_http_port(session: FakeSession) -> None:
    with running(session) as (port, _):
        claim = b"POST /api/render HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 2147483648\r\n\r\n{"
        noise = random.Random(7).randbytes(200) + b"\r\n\r\n"
        for data, answer in [(noise, b"400"), (claim, b"413"), (b"GET / HTTP/9.9\r\n\r\n", b"421")]:
            with socket.create_connection(("127.0.0.1", port), timeout=10) as raw:
                raw.sendall(data)
                raw.shutdown(socket.SHUT_WR)
                assert answer in raw.recv(4096)[:32]
        assert httpx2.get(f"http://127.0.0.1:{port}/api/health").json()["status"] == "ok"


def test_four_sessions_are_fed_alike_and_one_that_reads_nothing_slows_nobody(session: FakeSession) -> None:
    session.draw_seconds = 0.004

    async def drag(port: int, lazy: bool) -> int:
        client = await opened(port, state={"scene": "fake", "quality": {"kind": "draft"}})
        if lazy:
            await asyncio.sleep(2)
            await client.close()
            return 0
        frames = 0
        start = time.monotonic()
        step = 0
        while time.monotonic() - start < 1.5:
            step += 1
            await client.send(
                json.dumps({"type": "patch", "patch": {"brightness": 0.5 + step % 400 / 1000}, "id": step})
            )
            while True:
                message = await client.recv()
                if isinstance(message, bytes):
                    header = unpack(message)[0]
                    await client.send(json.dumps({"type": "ack", "sequence": header.sequence}))
                    frames += 1
                    break
        await client.close()
        return frames

    async def four(port: int) -> list[int]:
        return await asyncio.gather(*[drag(port, lazy=number == 3) for number in range(4)])

    with running(session) as (port, _):
        frames = asyncio.run(four(port))[:3]
    assert min(frames) > 0.6 * max(frames), frames
    assert min(frames) >= 8


def test_stopping_closes_open_sessions_with_a_code(session: FakeSession) -> None:
    async def stopped(port: int, server: uvicorn.Server) -> int:
        client = await opened(port)
        await idle(client)
        server.should_exit = True
        with pytest.raises(websockets.ConnectionClosed) as closed:
            await asyncio.wait_for(client.recv(), 10)
        assert closed.value.rcvd is not None
        return closed.value.rcvd.code

    with running(session) as (port, server):
        assert asyncio.run(stopped(port, server)) == 1012


def test_a_client_that_hangs_up_cancels_its_waiting_bake(session: FakeSession) -> None:
    session.bake_gate.clear()
    body = {"scene": "fake", "width": 8, "height": 8, "sets": {"density": 5}}
    with running(session) as (port, _):
        with pytest.raises(httpx2.TimeoutException):
            httpx2.post(f"http://127.0.0.1:{port}/api/render", json=body, timeout=0.5)
        deadline = time.monotonic() + 5
        while not session.preparations[-1].cancelled:
            assert time.monotonic() < deadline, "the bake went on for nobody"
            time.sleep(0.01)
        assert httpx2.get(f"http://127.0.0.1:{port}/metrics").text.count("umbrage_pictures_total 0.0") == 1


def test_the_address_is_one_that_a_person_can_open() -> None:
    assert address(Settings(), 8000) == "http://127.0.0.1:8000/"
    assert address(Settings(host="0.0.0.0", token="mine"), 80) == "http://127.0.0.1:80/?token=mine"
    assert address(Settings(host="::1"), 80) == "http://[::1]:80/"
