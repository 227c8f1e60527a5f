"""Errors as the doors say them: a sentence, the field, what is allowed; never the input, never a stack trace."""

from __future__ import annotations

import asyncio
import contextlib
import json
import logging
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from starlette.exceptions import HTTPException
from starlette.responses import Response

from renderer.core.documents import told
from renderer.core.errors import (
    Cancelled,
    GLUnavailable,
    InputError,
    InvalidDocument,
    LimitError,
    ShaderError,
    UmbrageError,
)
from server.protocol import finite

log = logging.getLogger("umbrage")
LONGEST_FIELD = 200
"""A field's path may hold a client's own key; a longer one is cut."""
FAILED = "the server could not do this; its log says why"


class Busy(LimitError):
    """The server has as much to do as it takes on; later it may have room."""


class Missing(InputError):
    """What an address names does not exist."""


@contextlib.contextmanager
def missing() -> Iterator[None]:
    """Make a refused name mean that the address names nothing."""
    try:
        yield
    except InputError as failure:
        raise Missing(failure.field, failure.message, failure.allowed) from None


class Json(Response):
    """JSON that any text survives: escaped to ASCII, without NaN."""

    media_type = "application/json"

    def render(self, content: Any) -> bytes:
        """The content as ASCII JSON."""
        return json.dumps(finite(content), allow_nan=False, separators=(",", ":")).encode("ascii")


def said(failure: BaseException) -> list[dict[str, str]]:
    """What is told of a failure: one entry a field."""
    if isinstance(failure, InvalidDocument):
        return [_cut(error.as_dict()) for error in failure.errors]
    if isinstance(failure, InputError):
        return [_cut(failure.as_dict())]
    if isinstance(failure, (Cancelled, CancelledError, asyncio.CancelledError)):
        return [{"field": "", "message": "the work was cancelled", "allowed": ""}]
    if isinstance(failure, (ShaderError, GLUnavailable, UmbrageError)):
        return [{"field": "", "message": str(failure), "allowed": ""}]
    log.error("unexpected failure", exc_info=failure)
    return [{"field": "", "message": FAILED, "allowed": ""}]


def _cut(entry: dict[str, str]) -> dict[str, str]:
    return {**entry, "field": entry["field"][:LONGEST_FIELD]}


def status_of(failure: BaseException) -> int:
    """HTTP status of a failure."""
    if isinstance(failure, Busy):
        return 503
    if isinstance(failure, Missing):
        return 404
    if isinstance(failure, (InvalidDocument, InputError)):
        return 422
    if isinstance(failure, GLUnavailable):
        return 503
    if isinstance(failure, Cancelled):
        return 409
    return 500


def refuse(status: int, field: str, message: str, allowed: str = "", headers: dict[str, str] | None = None) -> Json:
    """A response that refuses."""
    return Json({"errors": [{"field": field[:LONGEST_FIELD], "message": message, "allowed": allowed}]}, status, headers)


async def _umbrage(request: Request, failure: Exception) -> Response:
    headers = {"Retry-After": "5"} if isinstance(failure, Busy) else None
    return Json({"errors": said(failure)}, status_of(failure), headers)


async def _request(request: Request, failure: Exception) -> Response:
    """FastAPI's own handler echoes the input and fails on NaN; this one names the fields only."""
    found = failure.errors() if isinstance(failure, RequestValidationError) else []
    return Json({"errors": [_cut(told(error).as_dict()) for error in found]}, 422)


async def _http(request: Request, failure: Exception) -> Response:
    if isinstance(failure, HTTPException):
        return Json(
            {"errors": [{"field": "", "message": failure.detail, "allowed": ""}]}, failure.status_code, failure.headers
        )
    return await _unexpected(request, failure)


async def _unexpected(request: Request, failure: Exception) -> Response:
    return Json({"errors": said(failure)}, 500)


def install(app: FastAPI) -> None:
    """Make `app` answer every error in this form."""
    handlers: dict[type[Exception], Callable[[Request, Exception], Any]] = {
        UmbrageError: _umbrage,
        RequestValidationError: _request,
        HTTPException: _http,
        Exception: _unexpected,
    }
    for kind, handler in handlers.items():
        app.add_exception_handler(kind, handler)
