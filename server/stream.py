"""One live view over a WebSocket: reads messages and answers each.

States of the connection: greeting (only hello is understood), open, closed. Nothing a client sends ends it but a hello
of another protocol; everything else is answered by an error that names the field.
"""

from __future__ import annotations

import asyncio
import contextlib
import secrets
import time
from collections.abc import Coroutine
from typing import Any

from fastapi import WebSocket, WebSocketDisconnect
from pydantic import BaseModel
from starlette.websockets import WebSocketDisconnected

from renderer.core.errors import InputError, LimitError, UmbrageError
from server import protocol
from server.hub import Hub
from server.live import Live
from server.pace import Allowance
from server.painter import Painter
from server.problems import said
from server.rendering import first_preset

WRONG_PROTOCOL = 4400
TOO_MANY = 1013
GONE = (WebSocketDisconnect, WebSocketDisconnected, OSError)
"""What sending to a client that left raises."""
LIMITS = ("max_side", "max_pixels", "max_stream_pixels", "message_rate", "message_bytes", "upload_bytes", "sessions")


class Stream:
    """The state machine of one connection.

    Args:
        socket: accepted.
        hub: the server's.
    """

    def __init__(self, socket: WebSocket, hub: Hub) -> None:
        self.name = secrets.token_hex(4)
        self._socket, self._hub = socket, hub
        self._allowance = Allowance(hub.settings.message_rate, time.monotonic())
        self._live: Live | None = None
        self._tasks: set[asyncio.Task[None]] = set()

    @property
    def pixels(self) -> int:
        """Of the canvas; none before it is opened."""
        return 0 if self._live is None else self._live.painter.width * self._live.painter.height

    async def run(self) -> None:
        """Serve until the client leaves."""
        try:
            while True:
                event = await self._socket.receive()
                if event["type"] == "websocket.disconnect":
                    return
                await self._receive(event)
        except GONE:
            return
        finally:
            for task in self._tasks:
                task.cancel()
            if self._live is not None:
                self._live.close()
            await asyncio.gather(*self._tasks, return_exceptions=True)

    async def _tell(self, message: BaseModel) -> None:
        await self._socket.send_text(protocol.dump(message))

    async def _refuse(self, failure: BaseException, number: int | None = None) -> None:
        self._hub.metrics.refused.inc()
        for entry in said(failure):
            await self._tell(protocol.Refusal(**entry, id=number))

    async def _receive(self, event: Any) -> None:
        """Answer one message."""
        message, failure = _understood(event)
        # An acknowledgement costs nothing, and one that was dropped would stop the pictures. What is no message counts.
        if not isinstance(message, protocol.Ack) and not self._allowance.take(time.monotonic()):
            await self._overrun()
        elif failure is not None:
            await self._refuse(failure)
        else:
            await self._answer(message)
        await asyncio.sleep(0)  # a full socket never makes receiving wait: others must have their turn

    async def _answer(self, message: Any) -> None:
        try:
            if isinstance(message, protocol.Ping):
                await self._tell(protocol.Pong(id=message.id))
            elif isinstance(message, protocol.Hello):
                await self._hello(message)
            elif self._live is None:
                raise InputError("type", "the first message must be hello", "hello, ping")
            else:
                await self._dispatch(self._live, message)
        except GONE:
            raise
        except Exception as failure:  # a message never ends a session; what is unexpected is logged
            await self._refuse(failure, getattr(message, "id", None))

    async def _overrun(self) -> None:
        self._hub.metrics.refused.inc()
        if self._allowance.tell(time.monotonic()):
            limit = f"at most {self._hub.settings.message_rate} a second"
            await self._tell(protocol.Refusal(field="", message="too many messages; some were dropped", allowed=limit))

    async def _dispatch(self, live: Live, message: BaseModel) -> None:
        if isinstance(message, protocol.Patch):
            await live.patch(message.patch, message.id)
        elif isinstance(message, protocol.Replace):
            await live.replace(message.state, message.id)
        elif isinstance(message, protocol.Ack):
            live.painter.acknowledge(message.sequence)
        elif isinstance(message, protocol.Resize):
            self._check_size(message.width, message.height)
            live.painter.resize(message.width, message.height)
        elif isinstance(message, protocol.Probe):
            live.probe(message)
        elif isinstance(message, protocol.Compare):
            await live.compare(message.patch)
        elif isinstance(message, protocol.Moving):
            live.painter.hold(message.active)
        elif isinstance(message, protocol.Cancel):
            live.cancel()

    def _check_size(self, width: int, height: int) -> None:
        self._hub.check_size(width, height, self._hub.settings.max_stream_pixels)
        taken = sum(stream.pixels for stream in self._hub.streams if stream is not self)
        if taken + width * height > self._hub.settings.max_live_pixels:
            limit = f"{max(0, self._hub.settings.max_live_pixels - taken)} pixels now; more when another view closes"
            raise LimitError("width", "all live views together have too many pixels", limit)

    async def _hello(self, message: protocol.Hello) -> None:
        if self._live is not None:
            raise InputError("type", "this session was opened already", "state, patch, resize")
        if message.protocol != protocol.PROTOCOL:
            words = f"this server speaks protocol {protocol.PROTOCOL}; reload the page"
            await self._tell(protocol.Refusal(field="protocol", message=words, allowed=str(protocol.PROTOCOL)))
            await self._socket.close(WRONG_PROTOCOL, words)
            raise WebSocketDisconnect(WRONG_PROTOCOL)
        self._check_size(message.width, message.height)
        codecs: tuple[protocol.Codec, ...] = tuple(codec for codec in protocol.CODECS if codec in message.codecs)
        if not codecs:
            raise InputError("codecs", "none of these codecs is known", ", ".join(protocol.CODECS))
        opening = self._opening(message)
        state = await self._first_state(message, opening)
        document = state.model_dump(mode="json")
        info = self._hub.session.gl.info
        await self._tell(
            protocol.Welcome(
                session=self.name,
                version=1,
                state=document,
                scene=str(document["scene"]),
                limits={name: getattr(self._hub.settings, name) for name in LIMITS},
                gl={"renderer": info.renderer, "software": info.software},
            )
        )
        size = (message.width, message.height)
        painter = Painter(self._hub, self._socket.send_bytes, self._tell, codecs, message.frame_ms, size)
        self._live = Live(self._hub, painter, self._tell, self._spawn, state, opening)

    def _opening(self, message: protocol.Hello) -> BaseModel:
        """What the scene asked for opens with, its first preset; where there is no such scene, that of the first."""
        scenes = {str(scene["name"]): scene for scene in self._hub.session.scenes()}
        wanted = message.scene or str((message.state or {}).get("scene"))
        name = wanted if wanted in scenes else next(iter(scenes))
        return self._hub.session.state(name, first_preset(scenes[name]))

    async def _first_state(self, message: protocol.Hello, opening: BaseModel) -> BaseModel:
        """The state asked for; where none is, or it is refused, what the scene opens with."""
        session = self._hub.session
        try:
            if message.state is not None:
                return session.validate(message.state)
            own = str(opening.model_dump()["scene"])
            if message.preset is not None or message.scene not in (None, own):
                return session.state(message.scene or own, message.preset)
        except UmbrageError as failure:
            await self._refuse(failure)
        return opening

    def _spawn(self, work: Coroutine[Any, Any, None]) -> None:
        task: asyncio.Task[None] = asyncio.create_task(self._guard(work))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _guard(self, work: Coroutine[Any, Any, None]) -> None:
        """Sending to a client that left is no failure: the reader sees it leave."""
        try:
            await work
        except GONE:
            return
        except Exception as failure:  # a fault of ours: logged, and told rather than a frozen picture
            with contextlib.suppress(*GONE):
                await self._refuse(failure)


def _understood(event: Any) -> tuple[Any, UmbrageError | None]:
    """The message that came, or why it is none."""
    text = event.get("text")
    try:
        if text is None:
            raise InputError("", "binary messages are not understood", "JSON text")
        return protocol.parse(text), None
    except UmbrageError as failure:
        return None, failure


async def serve(socket: WebSocket, hub: Hub) -> None:
    """Accept a live view, or say that there are too many."""
    await socket.accept()
    if len(hub.streams) >= hub.settings.sessions:
        words = f"this server shows {hub.settings.sessions} live views at once; try again later"
        await socket.close(TOO_MANY, words)
        return
    stream = Stream(socket, hub)
    hub.streams.add(stream)
    hub.metrics.sessions.set(len(hub.streams))
    try:
        await stream.run()
    finally:
        hub.streams.discard(stream)
        hub.metrics.sessions.set(len(hub.streams))
