"""Follows the newest state of a pane until what it needs is precomputed; older wishes are dropped."""

from __future__ import annotations

import asyncio
import contextlib
import time
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel

from server import facade
from server.hub import Hub
from server.problems import said
from server.protocol import BakeProgress, Ready

PATIENCE_S = 0.1
PROGRESS_S = 0.1
"""Progress is told ten times a second at most."""


@dataclass(frozen=True)
class Wish:
    """A state to be prepared, and the version of the document it came from.

    Attributes:
        coarse: it stands for a finer one that is still on its way.
    """

    state: Any
    version: int
    coarse: bool = False


class Preparer:
    """Prepares the newest state; calls back on the event loop.

    Args:
        hub: the server's.
        tell: sends a message to the client.
        prepared: called with the wish once it can be drawn.
        failed: called with the wish and what to say, when it cannot be.
    """

    def __init__(
        self,
        hub: Hub,
        tell: Callable[[BaseModel], Awaitable[None]],
        prepared: Callable[[Wish], None],
        failed: Callable[[Wish, dict[str, str]], Awaitable[None]],
    ) -> None:
        self._hub, self._tell, self._prepared, self._failed = hub, tell, prepared, failed
        self._wish: Wish | None = None
        self._wake = asyncio.Event()
        self._running: facade.Preparation | None = None
        self._told_at = 0.0
        self._announced = False
        self._telling: asyncio.Task[None] | None = None

    def want(self, wish: Wish) -> None:
        """Prepare this instead of anything wished before; at once where nothing is to be computed."""
        self._wish = wish
        session = self._hub.session
        if self._running is None and not self._wake.is_set() and session.prepared(wish.state):
            self._prepared(wish)
            return
        if (soon := session.coarse(wish.state)) is not None and session.prepared(soon):
            self._prepared(Wish(soon, wish.version, coarse=True))
        self._wake.set()

    def cancel(self) -> None:
        """Stop the running precomputation, if there is one."""
        if self._running is not None:
            self._running.cancel()

    def drop(self) -> None:
        """Wish for nothing any more."""
        self._wish = None
        self.cancel()

    async def run(self) -> None:
        """Prepare until cancelled."""
        try:
            while True:
                await self._wake.wait()
                self._wake.clear()
                wish = self._wish
                if wish is not None:
                    await self._prepare(wish)
        finally:
            self.cancel()
            if self._telling is not None:
                self._telling.cancel()

    async def _prepare(self, wish: Wish) -> None:
        """Prepare a wish, after what may be shown sooner."""
        soon = self._hub.session.coarse(wish.state)
        if soon is not None and not self._hub.session.prepared(soon):
            shown = await self._follow(wish, Wish(soon, wish.version, coarse=True))
            if not shown:
                return
        await self._follow(wish, wish)

    async def _follow(self, wish: Wish, part: Wish) -> bool:
        """Prepare a wish or what stands for it; whether it is still wished for then."""
        older = self._running
        try:
            self._running = await self._start(wish, part.state)
        except Exception as failure:  # whatever the state asks for wrongly is told; the session lives on
            self._running = None
            await self._failed(wish, said(failure)[0])
            return False
        finally:
            if older is not None:
                # Only now: what both need goes on, since the newer wish holds it too.
                older.cancel()
        done = asyncio.wrap_future(self._running.future)
        done.add_done_callback(lambda future: future.cancelled() or future.exception())
        if not done.done() and not await self._first(done):
            return False
        self._running = None
        problem = asyncio.CancelledError() if done.cancelled() else done.exception()
        if problem is None and self._wish is not None:
            self._prepared(part)
        elif problem is not None and self._wish is wish:
            await self._failed(wish, said(problem)[0])
        if self._announced and not part.coarse:
            self._announced = False
            await self._tell(Ready())
        return problem is None and self._wish is wish

    async def _start(self, wish: Wish, state: Any) -> facade.Preparation:
        loop = asyncio.get_running_loop()

        def on_progress(advance: facade.Advance) -> None:
            loop.call_soon_threadsafe(self._progress, wish, advance)

        return await self._hub.prepare(state, on_progress)

    async def _first(self, done: asyncio.Future[None]) -> bool:
        """Wait until the preparation is over (True) or a newer wish came (False).

        A newer wish waits for a moment too: during a drag there is always one, and something must be shown.
        """
        newer = asyncio.create_task(self._wake.wait())
        waiting: set[asyncio.Future[Any]] = {done, newer}
        try:
            await asyncio.wait(waiting, return_when=asyncio.FIRST_COMPLETED)
            if not done.done():
                await asyncio.wait({done}, timeout=PATIENCE_S)
        finally:
            newer.cancel()
        return done.done()

    def _progress(self, wish: Wish, advance: facade.Advance) -> None:
        now = time.monotonic()
        busy = self._telling is not None and not self._telling.done()
        if wish is not self._wish or self._running is None or busy or now - self._told_at < PROGRESS_S:
            return
        self._told_at = now
        self._announced = True
        message = BakeProgress(
            name=advance.name, fraction=advance.fraction, words=advance.words, seconds_left=advance.seconds_left
        )
        self._telling = asyncio.create_task(self._quietly(message))

    async def _quietly(self, message: BaseModel) -> None:
        with contextlib.suppress(Exception):  # a client that left is noticed by the reader
            await self._tell(message)
