"""Sockets of the server: how they are bound, and how much is taken from one before the others have their turn."""

from __future__ import annotations

import asyncio
import socket

from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

from renderer.core.errors import InputError
from server.settings import Settings

READ_BYTES = 8192
"""Taken from a WebSocket at once. Every message in it is parsed before anybody else is served: asyncio's own 256 KiB
hold some ten thousand of the shortest, which is a second."""


class FairProtocol(WebSocketsSansIOProtocol):
    """A WebSocket that cannot keep the others waiting by the mass of what it sends."""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Take less at once than asyncio does; another loop's transports have their own measure."""
        if hasattr(transport, "max_size"):
            transport.max_size = READ_BYTES
        super().connection_made(transport)


def bind(settings: Settings) -> socket.socket:
    """The listening socket, named as TCP in so many words: asyncio sends small messages at once only then.

    Left to the default protocol number 0, it does not set TCP_NODELAY, and every picture would wait 40 ms for the
    delayed acknowledgement of the message before it.

    Raises:
        InputError: the address cannot be bound to.
    """
    family = socket.AF_INET6 if ":" in settings.host else socket.AF_INET
    listener = socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind((settings.host, settings.port))
    except OSError as failure:
        listener.close()
        raise InputError(
            "port",
            f"{settings.host}:{settings.port} cannot be bound to ({failure.strerror or failure})",
            "a free port of this machine; 0 for any",
        ) from None
    return listener
