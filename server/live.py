"""The document of one live view, and the pictures that follow it.

Every accepted change raises the version. Stream 0 shows the document, stream 1 what it is compared with.
"""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Coroutine
from typing import Any

from pydantic import BaseModel

from renderer.core.errors import InputError, UmbrageError
from renderer.core.params import merge
from server import protocol
from server.hub import Hub
from server.painter import Painter
from server.pane import Pane
from server.preparing import Preparer, Wish
from server.problems import said

PROBES = 8
"""Points of one session looked up at once."""
Document = dict[str, Any]


class Live:
    """What an open session holds.

    Args:
        hub: the server's.
        painter: draws its pictures.
        tell: sends a message.
        spawn: runs something beside the reader for as long as the session lives.
        state: the first state.
        opening: with which the scene opens, where the first state cannot be drawn.
    """

    def __init__(
        self,
        hub: Hub,
        painter: Painter,
        tell: Callable[[BaseModel], Awaitable[None]],
        spawn: Callable[[Coroutine[Any, Any, None]], None],
        state: BaseModel,
        opening: BaseModel,
    ) -> None:
        self.painter = painter
        self.document: Document = state.model_dump(mode="json")
        self.version = 1
        self._hub, self._tell, self._spawn = hub, tell, spawn
        self._preparers: list[Preparer] = []
        self._drawn: Document = opening.model_dump(mode="json")
        self._beside: Document | None = None
        self._probes = 0
        self._open_pane()
        spawn(painter.run())
        self._preparers[0].want(Wish(state, self.version))

    @property
    def panes(self) -> list[Pane]:
        """The streams that were opened."""
        return self.painter.panes

    async def patch(self, patch: Document, number: int | None) -> None:
        """Merge a patch into the document."""
        await self.replace(merge(self.document, patch), number)

    async def replace(self, document: Document, number: int | None) -> None:
        """Make a document the state of this session.

        Args:
            document: the whole state.
            number: id of the message that asked for it.

        Raises:
            InvalidDocument, InputError: it is refused, and nothing changed.
        """
        state = self._hub.session.validate(document)
        self.document = state.model_dump(mode="json")
        self.version += 1
        self.painter.touch()
        self._preparers[0].want(Wish(state, self.version))
        await self._tell(protocol.StateAccepted(version=self.version, state=self.document, id=number))
        if self._beside is not None:
            await self._show_beside()

    async def compare(self, patch: Document | None) -> None:
        """Open stream 1 with the document and this patch, or close it."""
        if patch is None:
            self._beside = None
            for pane, preparer in zip(self.panes[1:], self._preparers[1:], strict=True):
                preparer.drop()
                self.painter.drop(pane)
            return
        self._hub.session.validate(merge(self.document, patch))
        self._beside = patch
        if len(self.panes) < 2:
            self._open_pane()
        await self._show_beside()

    def cancel(self) -> None:
        """Cancel the running precomputation."""
        for preparer in self._preparers:
            preparer.cancel()

    def probe(self, message: protocol.Probe) -> None:
        """Look up what lies at a point.

        Raises:
            LimitError, InputError: too many are looked up, or there is no picture yet.
        """
        if self._probes >= PROBES:
            raise InputError("", "too many points are being looked up", f"{PROBES} at once")
        if self.panes[0].state is None:
            raise InputError("", "there is no picture yet")
        self._probes += 1
        self._spawn(self._probe(self.panes[0], message))

    def close(self) -> None:
        """Release the views; waits for nothing, so that even a cancelled connection does it."""
        for pane in self.panes:
            self._hub.callers.submit(pane.view.close)

    def _open_pane(self) -> None:
        index = len(self.panes)
        pane = Pane(1 if index else 0, self._hub.session.view())

        def prepared(wish: Wish) -> None:
            pane.accept(wish.state, wish.version)
            if index == 0 and not wish.coarse:
                self._drawn = wish.state.model_dump(mode="json")
            self.painter.wake()

        async def failed(wish: Wish, words: dict[str, str]) -> None:
            await self._tell(protocol.Refusal(**words))
            if index == 0 and wish.version == self.version and self.document != self._drawn:
                await self.replace(self._drawn, None)

        self.panes.append(pane)
        self._preparers.append(Preparer(self._hub, self._tell, prepared, failed))
        self._spawn(self._preparers[-1].run())

    async def _show_beside(self) -> None:
        """Show the document with the patch it is compared with; a patch that no longer fits is told."""
        try:
            state = self._hub.session.validate(merge(self.document, self._beside or {}))
        except UmbrageError as failure:
            for entry in said(failure):
                await self._tell(protocol.Refusal(**entry))
            return
        self._preparers[1].want(Wish(state, self.version))

    async def _probe(self, pane: Pane, message: protocol.Probe) -> None:
        try:
            found = protocol.finite(await asyncio.wrap_future(pane.view.probe(pane.state, message.x, message.y)))
            await self._tell(protocol.ProbeResult.model_validate({**found, "type": "probe", "id": message.id}))
        except UmbrageError as failure:
            for entry in said(failure):
                await self._tell(protocol.Refusal(**entry, id=message.id))
        finally:
            self._probes -= 1
