"""The same state at `samples(n)` gives identical pixels at every door; the real renderer draws, and bakes first."""

from __future__ import annotations

import asyncio
import io
import json
from pathlib import Path
from typing import Any

import httpx2
import numpy as np
import pytest
import websockets
from PIL import Image

from renderer.session import Session
from server import cli
from server.protocol import unpack
from tests.server.test_wire import running

SIZE = (96, 64)
PATCH: dict[str, Any] = {"sun": {"elevation": 12}, "quality": {"kind": "samples", "n": 3}}


async def streamed(port: int) -> np.ndarray:
    """The last picture of a live view that gets the state by a patch, after a moving sun."""
    async with websockets.connect(f"ws://127.0.0.1:{port}/api/session", max_size=None) as client:
        width, height = SIZE
        hello = {"type": "hello", "protocol": 1, "width": width, "height": height, "scene": "forest"}
        await client.send(json.dumps(hello))
        for elevation in (40, 30, 20):
            await client.send(json.dumps({"type": "patch", "patch": {"sun": {"elevation": elevation}}}))
        await client.send(json.dumps({"type": "patch", "patch": PATCH}))
        version, picture = 0, b""
        while True:
            message = await asyncio.wait_for(client.recv(), 110)
            if isinstance(message, bytes):
                header, picture = unpack(message)
                version = header.version
                await client.send(json.dumps({"type": "ack", "sequence": header.sequence}))
            elif json.loads(message)["type"] == "idle" and version == 5:
                return np.asarray(Image.open(io.BytesIO(picture)))


@pytest.mark.slow
def test_a_live_view_http_and_the_command_line_agree_to_the_last_bit(tmp_path: Path) -> None:
    with Session() as session, running(session) as (port, _):
        live = asyncio.run(streamed(port))
        body = {"scene": "forest", "sets": {"sun.elevation": 12}, "quality": PATCH["quality"]}
        asked = {**body, "width": SIZE[0], "height": SIZE[1]}
        answer = httpx2.post(f"http://127.0.0.1:{port}/api/render", json=asked, timeout=110)
        asked_linear = httpx2.post(
            f"http://127.0.0.1:{port}/api/render", json=asked, headers={"Accept": "application/x-npy"}, timeout=110
        )
    output = tmp_path / "x.npy"
    sets = ["--set", "sun.elevation=12", "--set", "quality.kind=samples", "--set", "quality.n=3"]
    assert cli.main(["render", "forest", *sets, "--size", "96x64", "-o", str(output)]) == 0
    assert np.array_equal(live, np.asarray(Image.open(io.BytesIO(answer.content))))
    assert np.array_equal(np.load(output), np.load(io.BytesIO(asked_linear.content)))
    assert live.std() > 5, "there is something in the picture"
