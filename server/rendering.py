"""Pictures on request: prepared, drawn off the event loop, given up when the client leaves."""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import Awaitable, Mapping
from typing import Any, TypeVar

from starlette.requests import Request

from renderer.core.errors import Cancelled, UmbrageError
from server import facade
from server.hub import Hub

T = TypeVar("T")
WARM_SIZE = (32, 32)
log = logging.getLogger("umbrage")


async def draw(hub: Hub, request: Request, state: Any, width: int, height: int) -> facade.Picture:
    """Draw a state at its own quality.

    Raises:
        Busy: too many pictures wait.
        Cancelled: the client left.
    """
    hub.check_size(width, height)
    with hub.admitted():
        left = asyncio.create_task(_left(request))
        try:
            return await _draw(hub, left, state, width, height)
        finally:
            left.cancel()


async def _draw(hub: Hub, left: asyncio.Task[None], state: Any, width: int, height: int) -> facade.Picture:
    if not await hub.call(hub.session.prepared, state):
        preparation = await hub.prepare(state)
        try:
            await _unless(left, asyncio.wrap_future(preparation.future))
        finally:
            preparation.cancel()  # no effect on what is finished; a client that left wants the rest no more
    stop = _Stop()
    loop = asyncio.get_running_loop()
    drawing = loop.run_in_executor(hub.renderers, hub.session.render, state, width, height, stop.check)
    try:
        picture = await _unless(left, drawing)
    except Cancelled:
        stop.asked = True
        raise
    hub.metrics.pictures.inc()
    return picture


class _Stop:
    """A progress callback that ends the work once it is no longer wanted."""

    asked = False

    def check(self, progress: Any) -> None:
        if self.asked:
            raise Cancelled("the client left")


async def _left(request: Request) -> None:
    """Return when the client closes its connection; the body was read before."""
    while (await request.receive())["type"] != "http.disconnect":
        pass


async def _unless(left: asyncio.Task[None], work: Awaitable[T]) -> T:
    """Wait for `work`; cancel it when the client leaves first.

    Raises:
        Cancelled: the client left.
    """
    doing = asyncio.ensure_future(work)
    try:
        await asyncio.wait({left, doing}, return_when=asyncio.FIRST_COMPLETED)
    finally:
        if not doing.done():
            doing.cancel()
    if doing.done() and not doing.cancelled():
        return doing.result()
    with contextlib.suppress(asyncio.CancelledError):
        await doing
    raise Cancelled("the client left before the picture was drawn")


def first_preset(scene: Mapping[str, Any]) -> str | None:
    """The preset with which a scene opens, or None where it has none.

    Args:
        scene: one entry of `scenes()`.
    """
    presets = scene["presets"]
    return str(presets[0]["name"]) if presets else None


async def warm_up(hub: Hub) -> None:
    """Precompute the first scene's first preset and compile its programs, so that the first visitor need not wait."""
    session = hub.session
    try:
        scene = session.scenes()[0]
        state = await hub.call(session.state, str(scene["name"]), first_preset(scene), {"quality.kind": "draft"})
        preparation = await hub.prepare(state)
        try:
            await asyncio.wrap_future(preparation.future)
        finally:
            preparation.cancel()
        await asyncio.get_running_loop().run_in_executor(hub.renderers, session.render, state, *WARM_SIZE)
    except UmbrageError as failure:
        log.warning("the first scene is not ready: %s", failure)
