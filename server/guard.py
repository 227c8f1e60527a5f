"""Who may come in, and how much they may carry: pure ASGI, in front of everything else."""

from __future__ import annotations

import contextlib
import hmac
from http.cookies import CookieError, SimpleCookie
from urllib.parse import parse_qs, urlsplit

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from server.problems import refuse
from server.settings import LOOPBACK, Settings

COOKIE = "umbrage_token"
OPEN_PATHS = frozenset({"/api/health"})
"""Asked by container health checks, which carry no token; it tells nothing that an address scan would not."""
SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})
MULTIPART_SURPLUS = 64 << 10
"""Bytes of an upload's form around the file itself."""
HEADERS = {
    "Content-Security-Policy": "default-src 'self'; img-src 'self' blob: data:; object-src 'none'; base-uri 'none'; "
    "form-action 'self'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}


class TooLarge(Exception):
    """A body grew beyond its limit while it was read."""


class Guard:
    """Checks host, origin, token and size of every request.

    Args:
        app: what it guards.
        settings: the operator's.
    """

    def __init__(self, app: ASGIApp, settings: Settings) -> None:
        self._app, self._settings = app, settings
        self._hosts = frozenset(settings.hosts.lower().split())
        self._origins = frozenset(origin.lower().rstrip("/") for origin in settings.origins.split())

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Let a request pass, or refuse it in words."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        refusal = self._foreign(scope, headers)
        token = self._token(scope, headers)
        if refusal is None and self._settings.token and scope["path"] not in OPEN_PATHS and not self._right(token):
            refusal = (
                401,
                "token",
                "this server asks for its token",
                "?token= in the address, or Authorization: Bearer",
            )
        limit = self._limit(scope)
        claimed = headers.get("content-length", "")
        if refusal is None and claimed.isdigit() and (len(claimed) > 18 or int(claimed) > limit):
            refusal = (413, "", "the request's body is too large", f"at most {limit} bytes")
        if refusal is not None:
            await self._refuse(scope, receive, send, *refusal)
        elif scope["type"] == "websocket":
            await self._app(scope, receive, send)
        else:
            await self._pass(scope, receive, send, limit)

    async def _refuse(
        self, scope: Scope, receive: Receive, send: Send, status: int, field: str, message: str, allowed: str
    ) -> None:
        if scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.close", "code": 4401, "reason": message})
            return
        await refuse(status, field, message, allowed, {**HEADERS, "Connection": "close"})(scope, receive, send)

    async def _pass(self, scope: Scope, receive: Receive, send: Send, limit: int) -> None:
        taken = 0
        started = over = False

        async def counted() -> Message:
            nonlocal taken, over
            message = await receive()
            taken += len(message.get("body", b""))
            if taken > limit:
                over = True
                raise TooLarge
            return message

        async def dressed(message: Message) -> None:
            nonlocal started
            if over and not started:
                return  # whatever the application makes of it, the answer is the one below
            if message["type"] == "http.response.start":
                started = True
                headers = MutableHeaders(scope=message)
                for name, value in HEADERS.items():
                    headers.setdefault(name, value)
                self._remember(scope, headers)
            await send(message)

        with contextlib.suppress(TooLarge):
            await self._app(scope, counted, dressed)
        if over and not started:
            await self._refuse(
                scope, receive, send, 413, "", "the request's body is too large", f"at most {limit} bytes"
            )

    def _limit(self, scope: Scope) -> int:
        """Largest body of this request [bytes]."""
        if scope["path"] == "/api/assets":
            return self._settings.upload_bytes + MULTIPART_SURPLUS
        return self._settings.body_bytes

    def _foreign(self, scope: Scope, headers: Headers) -> tuple[int, str, str, str] | None:
        """Why a request comes from somewhere it must not, or None."""
        host = headers.get("host", "").lower()
        name = _name(host)
        known = self._hosts | LOOPBACK | {self._settings.host.lower()}
        if (self._settings.loopback or self._hosts) and name not in known:
            # A page elsewhere may make its own name resolve to this address (DNS rebinding).
            return 421, "Host", "this server does not answer to that name", " ".join(sorted(known))
        origin = headers.get("origin", "").lower().rstrip("/")
        guarded = scope["type"] == "websocket" or scope["method"] not in SAFE_METHODS
        if guarded and origin and origin not in self._origins and _place(origin) != host:
            return 403, "Origin", "a page of another origin may not use this server", "the server's own origin"
        return None

    def _token(self, scope: Scope, headers: Headers) -> str:
        scheme, _, bearer = headers.get("authorization", "").partition(" ")
        if scheme.lower() == "bearer":
            return bearer.strip()
        asked = parse_qs(scope.get("query_string", b"").decode("latin-1")).get("token")
        if asked:
            return str(asked[0])
        try:
            cookies: SimpleCookie = SimpleCookie(headers.get("cookie", ""))
        except CookieError:
            return ""
        value: str = cookies[COOKIE].value if COOKIE in cookies else ""
        return value

    def _right(self, token: str) -> bool:
        return hmac.compare_digest(token.encode("utf-8", "replace"), self._settings.token.encode())

    def _remember(self, scope: Scope, headers: MutableHeaders) -> None:
        """The page is opened with the token in its address once; its own requests carry it as a cookie."""
        if self._settings.token and scope["path"] == "/" and b"token=" in scope.get("query_string", b""):
            headers.append("Set-Cookie", f"{COOKIE}={self._settings.token}; Path=/; HttpOnly; SameSite=Strict")


def _place(origin: str) -> str:
    """Host and port of an Origin header; empty, and so nobody's, where it is no address."""
    try:
        return urlsplit(origin).netloc
    except ValueError:
        return ""


def _name(host: str) -> str:
    """The name in a Host header, without its port and brackets."""
    if host.startswith("["):
        return host[1:].partition("]")[0]
    return host.partition(":")[0]
