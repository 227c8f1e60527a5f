"""Receives one uploaded file onto the disk as it comes: it is never whole in memory, no claimed length is believed."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator, Awaitable, Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from python_multipart.exceptions import FormParserError
from python_multipart.multipart import MultipartParser, parse_options_header
from starlette.requests import ClientDisconnect, Request

from renderer.core.errors import InputError, LimitError

if TYPE_CHECKING:
    from python_multipart.multipart import MultipartCallbacks

FIELD = b"file"
LONGEST_HEADER = 4096
"""Bytes of a part's headers; a file's name and type need far less."""
LONGEST_FIELD = 4096
"""Bytes of all fields beside the file, names and values; a reading needs some hundred."""
STALLED_S = 30.0
"""How long a client may send nothing: whoever holds one of the few places for requests has to use it."""


@dataclass(frozen=True)
class Received:
    """What came beside the file's bytes.

    Attributes:
        name: the client's name of the file, without any folder.
        fields: the form's other fields; numbers and lists are JSON, anything else is text.
    """

    name: str
    fields: dict[str, Any]


class Part:
    """What the parser found so far; its methods are the parser's callbacks.

    Attributes:
        name: the client's name of the file, None before it came.
        ended: whether the form was complete.
        fields: the form's other fields, as they came.
        pending: bytes of the file that are not on the disk yet.
    """

    def __init__(self) -> None:
        self.name: str | None = None
        self.ended = False
        self.pending: list[bytes] = []
        self.fields: dict[bytes, bytes] = {}
        self._wanted = False
        self._other = b""
        self._field = b""
        self._value = b""
        self._disposition = b""

    def callbacks(self) -> MultipartCallbacks:
        """As the parser asks for them."""
        return {
            "on_header_field": self._header_field,
            "on_header_value": self._header_value,
            "on_header_end": self._header_end,
            "on_headers_finished": self._headers_finished,
            "on_part_data": self._part_data,
            "on_part_end": self._part_end,
            "on_end": self._end,
        }

    def _header_field(self, data: bytes, start: int, end: int) -> None:
        self._field = _grown(self._field, data[start:end])

    def _header_value(self, data: bytes, start: int, end: int) -> None:
        self._value = _grown(self._value, data[start:end])

    def _header_end(self) -> None:
        if self._field.lower() == b"content-disposition":
            self._disposition = self._value
        self._field = self._value = b""

    def _headers_finished(self) -> None:
        _, options = parse_options_header(self._disposition)
        self._other = options.get(b"name", b"")
        self._wanted = self._other == FIELD and b"filename" in options
        if self._wanted and self.name is not None:
            raise InputError("file", "there are several files in this upload", "one file")
        if self._wanted:
            self.name = options[b"filename"].decode("utf-8", "replace")
        else:
            self._keep(self._other, b"")

    def _part_data(self, data: bytes, start: int, end: int) -> None:
        if self._wanted:
            self.pending.append(data[start:end])
        else:
            self._keep(self._other, data[start:end])

    def _keep(self, field: bytes, more: bytes) -> None:
        self.fields[field] = self.fields.get(field, b"") + more
        if sum(len(name) + len(value) for name, value in self.fields.items()) > LONGEST_FIELD:
            raise LimitError("file", "the fields beside the file are too long", f"at most {LONGEST_FIELD} bytes")

    def _part_end(self) -> None:
        self._wanted = False
        self._disposition = b""

    def _end(self) -> None:
        self.ended = True


def _grown(text: bytes, more: bytes) -> bytes:
    if len(text) + len(more) > LONGEST_HEADER:
        raise InputError("file", "the headers of this upload are too long", f"at most {LONGEST_HEADER} bytes")
    return text + more


async def receive(request: Request, path: Path, limit: int, call: Callable[..., Awaitable[Any]]) -> Received:
    """Write the field `file` of a multipart form to `path`.

    Args:
        request: whose body was not read yet.
        path: of the new file.
        limit: its largest size [bytes].
        call: runs a blocking function elsewhere.

    Raises:
        InputError: no form, no file in it, an empty file, or a form that was cut short.
        LimitError: the file is larger than the limit, or its client stalled.
    """
    media, options = parse_options_header(request.headers.get("content-type", ""))
    boundary = options.get(b"boundary", b"")
    if media != b"multipart/form-data" or not boundary:
        raise InputError("file", "the body is no form with a file", "multipart/form-data with a field file")
    part = Part()
    chunks = request.stream()
    with path.open("wb") as target:
        try:
            parser = MultipartParser(boundary, part.callbacks())
            while (chunk := await _next(chunks)) is not None:
                parser.write(chunk)
                await call(_drain, part, target, limit)
        except FormParserError:
            raise InputError("file", "the form is broken") from None
        size = target.tell()
    if not part.ended:
        raise InputError("file", "the upload was cut short")
    if part.name is None:
        raise InputError("file", "is missing", "a form's field with a file name")
    if size == 0:
        raise InputError("file", "the file is empty")
    fields = {_text(name): _value(_text(value)) for name, value in part.fields.items()}
    return Received(Path(part.name.replace("\\", "/")).name[:200], fields)


async def _next(chunks: AsyncIterator[bytes]) -> bytes | None:
    """The next piece of the body, or None at its end."""
    try:
        async with asyncio.timeout(STALLED_S):
            return await anext(chunks, None)
    except TimeoutError:
        raise LimitError("file", "the upload stalled", f"at most {STALLED_S:g} s without a byte") from None
    except ClientDisconnect:
        raise InputError("file", "the upload was cut short") from None


def _text(data: bytes) -> str:
    return data.decode("utf-8", "replace")


def _value(text: str) -> Any:
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return text


def _drain(part: Part, target: BinaryIO, limit: int) -> None:
    for data in part.pending:
        if target.tell() + len(data) > limit:
            raise LimitError("file", "the file is too large", f"at most {limit} bytes")
        target.write(data)
    part.pending.clear()
