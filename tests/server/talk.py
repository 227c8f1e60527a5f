"""A client of the WebSocket for tests."""

from __future__ import annotations

import io
import json
import time
from typing import Any

import numpy as np
from PIL import Image
from starlette.testclient import WebSocketTestSession

from server.protocol import FrameHeader, unpack

Message = dict[str, Any]


class Talk:
    """Reads frames and messages; acknowledges frames where told to."""

    def __init__(self, socket: WebSocketTestSession, acknowledging: bool = True) -> None:
        self.socket = socket
        self.acknowledging = acknowledging
        self.frames: list[tuple[FrameHeader, bytes]] = []
        self.messages: list[Message] = []

    def send(self, **message: Any) -> None:
        self.socket.send_text(json.dumps(message))

    def next(self) -> Message | FrameHeader:
        event = self.socket.receive()
        if event["type"] == "websocket.close":
            return {"type": "closed", "code": event["code"], "reason": event["reason"]}
        if event.get("bytes") is not None:
            header, image = unpack(event["bytes"])
            self.frames.append((header, image))
            if self.acknowledging:
                self.send(type="ack", sequence=header.sequence)
            return header
        message: Message = json.loads(event["text"])
        self.messages.append(message)
        return message

    def until(self, kind: str, within: int = 300) -> Message:
        """The next text message of this type; frames and others before it are kept."""
        for _ in range(within):
            found = self.next()
            if isinstance(found, dict) and found["type"] == kind:
                return found
        raise AssertionError(f"no {kind} came in {within} messages")

    def frame(self, within: int = 300) -> FrameHeader:
        """The next frame."""
        for _ in range(within):
            found = self.next()
            if isinstance(found, FrameHeader):
                return found
        raise AssertionError(f"no frame came in {within} messages")

    def silent(self, seconds: float) -> bool:
        """Whether the server sends nothing for so long: a ping's answer is the next thing that comes."""
        time.sleep(seconds)
        self.send(type="ping", id=99)
        return self.next() == {"type": "pong", "id": 99}


def pixels(image: bytes) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(image)).convert("RGB"))
