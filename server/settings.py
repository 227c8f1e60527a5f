"""What the operator decides: address, access and limits, read from the environment."""

from __future__ import annotations

import os
import secrets
from collections.abc import Mapping
from pathlib import Path

from renderer.core.errors import InputError, InvalidDocument
from renderer.core.params import Model, param, validate

PREFIX = "UMBRAGE_"
LOOPBACK = frozenset({"127.0.0.1", "localhost", "::1"})
ROOT = Path(__file__).resolve().parent.parent
"""The checkout, which holds the page and the study's results."""


class Settings(Model):
    """Settings of one server process; each field is read from `UMBRAGE_<FIELD>`."""

    host: str = param("127.0.0.1", label="Host", help="Address to bind to", cost="host", max_length=255)
    port: int = param(8000, label="Port", help="TCP port, 0 for any free one", cost="host", ge=0, le=65535)
    token: str = param(
        "",
        label="Token",
        help="Secret that every client must show; empty for none on a loopback address",
        pattern=r"^[A-Za-z0-9._~-]*$",
        cost="host",
        max_length=200,
    )
    origins: str = param(
        "",
        label="Origins",
        cost="host",
        max_length=4000,
        help="Web origins allowed besides the server's own, separated by spaces",
    )
    hosts: str = param(
        "",
        label="Host names",
        cost="host",
        max_length=4000,
        help="Names under which clients may address the server, separated by spaces",
    )
    max_side: int = param(
        4096, label="Largest side", help="Width or height of a picture", unit="px", cost="host", ge=16, le=16384
    )
    max_pixels: int = param(
        4096 * 4096,
        label="Largest picture",
        help="Pixels of a rendered picture",
        unit="count",
        cost="host",
        ge=256,
        le=16384 * 16384,
    )
    max_stream_pixels: int = param(
        3840 * 2160,
        label="Largest view",
        help="Pixels of a live view",
        unit="count",
        cost="host",
        ge=256,
        le=16384 * 16384,
    )
    max_live_pixels: int = param(
        32 * 1920 * 1080,
        label="All views",
        help="Pixels of all live views together",
        unit="count",
        cost="host",
        ge=256,
        le=1 << 40,
    )
    sessions: int = param(
        32, label="Sessions", help="Live views served at once", unit="count", cost="host", ge=1, le=10000
    )
    jobs: int = param(
        16, label="Jobs", help="Long jobs queued or running at once", unit="count", cost="host", ge=1, le=1000
    )
    jobs_running: int = param(
        1, label="Running jobs", help="Long jobs running at once", unit="count", cost="host", ge=1, le=64
    )
    jobs_kept: float = param(
        3600.0,
        label="Results kept",
        help="How long the result of a job is kept",
        unit="s",
        cost="host",
        ge=1,
        le=30 * 86400,
    )
    requests: int = param(
        16,
        label="Requests",
        help="Pictures, measurements and uploads that may wait at once",
        unit="count",
        cost="host",
        ge=1,
        le=1000,
    )
    upload_bytes: int = param(
        256 << 20, label="Upload", help="Largest upload in bytes", unit="count", cost="host", ge=1024, le=16 << 30
    )
    body_bytes: int = param(
        1 << 20, label="Body", help="Largest JSON body in bytes", unit="count", cost="host", ge=1024, le=1 << 28
    )
    message_bytes: int = param(
        256 << 10,
        label="Message",
        help="Largest WebSocket message in bytes",
        unit="count",
        cost="host",
        ge=1024,
        le=1 << 26,
    )
    message_rate: int = param(
        400,
        label="Message rate",
        help="WebSocket messages of one session in a second",
        unit="count",
        cost="host",
        ge=10,
        le=100000,
    )
    study: str = param(
        str(ROOT / "out" / "study"), label="Study", help="Folder of the study's results", cost="host", max_length=4000
    )

    @property
    def loopback(self) -> bool:
        """Whether the server is bound where only this machine reaches it."""
        return self.host in LOOPBACK

    def secured(self) -> Settings:
        """These settings, with a random token where the address is public and none was given."""
        if self.loopback or self.token:
            return self
        return self.model_copy(update={"token": secrets.token_urlsafe(24)})


def load(environment: Mapping[str, str] | None = None, **given: object) -> Settings:
    """Settings from the environment, overridden by what was given on the command line.

    Args:
        environment: variables; `UMBRAGE_*` that name no setting are left to others (the cache reads one).
        given: fields that are not None override.

    Raises:
        InputError: a value is wrong; the field is the variable's name.
    """
    source = os.environ if environment is None else environment
    document: dict[str, object] = {}
    for name in Settings.model_fields:
        if PREFIX + name.upper() in source:
            document[name] = _value(source[PREFIX + name.upper()], Settings.model_fields[name].annotation)
    document.update({name: value for name, value in given.items() if value is not None})
    try:
        return validate(Settings, document)
    except InvalidDocument as failure:
        first = failure.errors[0]
        raise InputError(PREFIX + first.field.upper(), first.message, first.allowed) from None


def _value(text: str, annotation: object) -> object:
    """A variable's text as the number its field wants; other text stays, for validation to refuse in words."""
    try:
        return annotation(text) if annotation is int or annotation is float else text
    except ValueError:
        return text
