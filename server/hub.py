"""What all requests of one server share."""

from __future__ import annotations

import asyncio
import contextlib
import functools
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Annotated, Any, TypeVar

from fastapi import Depends, FastAPI
from starlette.requests import HTTPConnection

from renderer.core.errors import LimitError
from server.facade import Advance, Preparation, RenderSession
from server.jobs import Jobs
from server.metrics import Metrics
from server.pace import Movers
from server.problems import Busy
from server.settings import Settings

T = TypeVar("T")


class Hub:
    """The session, the settings and the threads of one server.

    Encoding, short calls, renders and other work of seconds have threads of their own: none waits behind another kind.
    """

    def __init__(self, session: RenderSession, settings: Settings) -> None:
        self.session = session
        self.settings = settings
        self.metrics = Metrics()
        self.encoders = ThreadPoolExecutor(2, "encode")
        self.callers = ThreadPoolExecutor(8, "call")
        self.renderers = ThreadPoolExecutor(2, "render")
        self.workers = ThreadPoolExecutor(4, "work")
        self.jobs = Jobs(settings, self.metrics)
        self.streams: set[Any] = set()
        self.movers = Movers()
        self._admitted = 0
        self.thumbnails: dict[str, bytes] = {}
        self.thumbnail_locks: dict[str, asyncio.Lock] = {}

    async def call(self, function: Callable[..., T], *arguments: Any, **named: Any) -> T:
        """Run a short blocking function off the event loop."""
        return await asyncio.get_running_loop().run_in_executor(
            self.callers, functools.partial(function, *arguments, **named)
        )

    async def prepare(self, state: Any, on_progress: Callable[[Advance], None] | None = None) -> Preparation:
        """Start a precomputation off the event loop.

        Whoever is cancelled meanwhile leaves none behind that nobody holds: what was being started is dropped, in the
        thread that starts it, since the event loop may be over by then.
        """
        starting = self.callers.submit(self.session.prepare, state, on_progress)
        try:
            return await asyncio.wrap_future(starting)
        except asyncio.CancelledError:
            starting.add_done_callback(_drop)
            raise

    async def work(self, function: Callable[..., T], *arguments: Any) -> T:
        """Run something that may take seconds off the event loop.

        Raises:
            Busy: as much waits as may.
        """
        with self.admitted():
            return await self.busy(function, *arguments)

    async def busy(self, function: Callable[..., T], *arguments: Any) -> T:
        """As `work`, for a request that was admitted before."""
        return await asyncio.get_running_loop().run_in_executor(self.workers, function, *arguments)

    def check_size(self, width: int, height: int, pixels: int | None = None) -> None:
        """Refuse a picture that is too large.

        Raises:
            LimitError: naming the side, or both, and the limit.
        """
        side = self.settings.max_side
        limit = self.settings.max_pixels if pixels is None else pixels
        for field, value in (("width", width), ("height", height)):
            if not 1 <= value <= side:
                raise LimitError(field, f"{value} px is no size this server draws", f"1 to {side} px")
        if width * height > limit:
            raise LimitError("width", f"{width} x {height} pixels are too many", f"width x height at most {limit}")

    @contextlib.contextmanager
    def admitted(self) -> Iterator[None]:
        """Count one more piece of work asked over HTTP.

        Raises:
            Busy: as much waits as may.
        """
        if self._admitted >= self.settings.requests:
            raise Busy("", "the server is busy with other requests", f"{self.settings.requests} at once")
        self._admitted += 1
        try:
            yield
        finally:
            self._admitted -= 1

    async def close(self) -> None:
        """Cancel what waits; what runs ends with the session, which is closed next."""
        await self.jobs.close()
        for pool in (self.encoders, self.callers, self.renderers, self.workers):
            pool.shutdown(wait=False, cancel_futures=True)


def _drop(started: Future[Preparation]) -> None:
    """Let go of a precomputation that nobody waits for."""
    if not started.cancelled() and started.exception() is None:
        started.result().cancel()


def hub_of(connection: HTTPConnection) -> Hub:
    """The hub of the server that a request reached."""
    found: Hub = connection.app.state.hub
    return found


def install(app: FastAPI, hub: Hub) -> None:
    """Make `hub` the one of `app`."""
    app.state.hub = hub


TheHub = Annotated[Hub, Depends(hub_of)]
