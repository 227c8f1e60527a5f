"""Decides what a live view draws next, and sends it.

Newest state wins; at most two frames are unacknowledged; while things move the resolution holds the frame time; at rest
the picture is refined by samples until it converges, its last form is lossless, and then there is silence.
"""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Awaitable, Callable

from pydantic import BaseModel

from server import facade
from server.encode import MOVING_QUALITY, RESTING_QUALITY, encode
from server.hub import Hub
from server.pace import LOWEST_SCALE, ScaleController, scaled
from server.pane import Pane, Task
from server.problems import said
from server.protocol import Codec, FrameHeader, Idle, Refusal, pack

log = logging.getLogger("umbrage")
IN_FLIGHT = 2
RESTED_S = 0.060
"""The view moves until no change came for this long: a full picture must follow the last change within 0.15 s."""
PATIENCE = 2.0
"""Changes come no faster than pictures: they are waited for during so many times the last one, however slow it was."""
PREVIEW_MS = 100.0
"""A picture that takes longer is shown coarsely first."""
COURTESY = 4.0
"""While another view moves, a picture is refined for a fifth of the time only."""
SMALL_PIXELS = 512 * 512
"""Up to here the lossless picture is quick enough to be the first one at rest."""


class Painter:
    """The drawing loop of one live view.

    Args:
        hub: the server's.
        send: sends a binary message.
        tell: sends a text message.
        codecs: what the client decodes.
        frame_ms: frame time to hold while moving [ms].
        size: width and height of the canvas [px].
    """

    def __init__(
        self,
        hub: Hub,
        send: Callable[[bytes], Awaitable[None]],
        tell: Callable[[BaseModel], Awaitable[None]],
        codecs: tuple[Codec, ...],
        frame_ms: float,
        size: tuple[int, int],
    ) -> None:
        self._hub, self._send, self._tell = hub, send, tell
        self._moving_codec: Codec = "jpeg" if "jpeg" in codecs else "png"
        self._final_codec: Codec = "png" if "png" in codecs else "jpeg"
        self.width, self.height = size
        self.panes: list[Pane] = []
        self._controller = ScaleController(frame_ms)
        self._wake = asyncio.Event()
        self._timer: asyncio.TimerHandle | None = None
        self._touched = -1e9
        self._coarse_s = 0.0
        self._pause_until = -1e9
        self._turn = 0
        self._sequence = 0
        self._last_sent = 0
        self._encode_ms = 0.0
        self._unacknowledged: set[int] = set()
        self._delivery: asyncio.Task[None] | None = None
        self._deliveries: set[asyncio.Task[None]] = set()
        self._idle = True

    def wake(self) -> None:
        """Something changed: look again for what to do."""
        self._idle = False
        self._wake.set()

    def drop(self, pane: Pane) -> None:
        """Show this stream no more."""
        pane.state = None
        self._wake.set()

    def touch(self) -> None:
        """The state was changed by hand just now."""
        self._touched = time.monotonic()

    def hold(self, active: bool) -> None:
        """A pointer went down, or up: up means rest at once."""
        if not active:
            self._touched = -1e9
            self._wake.set()

    def resize(self, width: int, height: int) -> None:
        """The canvas has another size [px]."""
        if (width, height) != (self.width, self.height):
            self.width, self.height = width, height
            self._controller.forget()
            self.wake()

    def acknowledge(self, sequence: int) -> None:
        """The client drew this frame, and so every earlier one."""
        drawn = min(sequence, self._last_sent)
        self._unacknowledged = {number for number in self._unacknowledged if number > drawn}
        self._wake.set()

    async def run(self) -> None:
        """Draw until cancelled."""
        try:
            while True:
                await self._wake.wait()
                self._wake.clear()
                while (task := self._next()) is not None:
                    await self._do(task)
                await self._rest()
        finally:
            if self._timer is not None:
                self._timer.cancel()
            for delivery in self._deliveries:
                delivery.cancel()

    def _moving_until(self) -> float:
        return self._touched + max(RESTED_S, PATIENCE * self._coarse_s)

    def _next(self) -> Task | None:
        """The next thing to do, or None where nothing is to be done or the client is behind."""
        if len(self._unacknowledged) >= IN_FLIGHT:
            return None
        now = time.monotonic()
        moving = now < self._moving_until()
        for step in range(len(self.panes)):
            pane = self.panes[(self._turn + step) % len(self.panes)]
            known = pane.shown is not None and pane.shown[0] == pane.version
            scale = self._scale(pane, known, moving)
            width, height = scaled(self.width, self.height, scale or 1.0)
            key, target = (pane.serial, width, height), (pane.version, width, height)
            done = known if moving else pane.final == target
            refining = not moving and pane.shown == target
            if pane.state is not None and not done and not (refining and now < self._pause_until):
                self._turn = (pane.index + 1) % len(self.panes)
                return Task(pane, pane.state, scale or 1.0, key, target, coarse=scale is not None)
        return None

    def _scale(self, pane: Pane, known: bool, moving: bool) -> float | None:
        """Linear scale of a coarse picture, or None where the full one is due.

        Args:
            pane: to be drawn.
            known: whether its version was shown in any form.
            moving: whether the view moves.
        """
        if moving:
            return self._controller.scale
        if known or pane.drawn == (pane.serial, self.width, self.height):
            return None
        expected = self._controller.expected_ms
        if expected is None:
            return LOWEST_SCALE if self.width * self.height > SMALL_PIXELS else None
        return LOWEST_SCALE if expected > PREVIEW_MS else None

    async def _rest(self) -> None:
        """Nothing to do now: look again when the movement is over, or say so once."""
        wait = max(self._moving_until(), self._pause_until) - time.monotonic()
        if wait > 0:
            if self._timer is not None:
                self._timer.cancel()
            self._timer = asyncio.get_running_loop().call_later(wait + 1e-3, self._wake.set)
            return
        size = self.width, self.height
        shown = [pane for pane in self.panes if pane.state is not None]
        if self._idle or not shown or any(pane.final != (pane.version, *size) for pane in shown):
            return
        if self._delivery is not None:
            await self._delivery
        self._idle = True
        samples = min(pane.frame.samples for pane in shown if pane.frame is not None)
        await self._tell(Idle(samples=samples))

    async def _do(self, task: Task) -> None:
        """Draw one sample (or take the picture that is already there), and send it where it is worth sending."""
        pane = task.pane
        fresh = pane.drawn == task.key and pane.frame is not None and (pane.frame.converged or task.coarse)
        if not fresh and not await self._draw(task):
            return
        frame = pane.frame
        if frame is None:
            return
        first = pane.shown != task.target
        preview = first and self._final_codec == "png" and task.key[1] * task.key[2] > SMALL_PIXELS
        if task.coarse:
            self._deliver(task, frame, self._moving_codec, MOVING_QUALITY)
        elif frame.converged and not preview:
            pane.final = pane.final if task.overtaken else task.target
            self._deliver(task, frame, self._final_codec, RESTING_QUALITY)
        elif first or frame.samples >= 2 * pane.sent:
            self._deliver(task, frame, self._moving_codec, RESTING_QUALITY)

    async def _draw(self, task: Task) -> bool:
        """Draw one more sample of the pane's state; False where it failed or was overtaken."""
        pane = task.pane
        start = time.perf_counter()
        future = pane.view.frame(task.state, task.key[1], task.key[2], 1)
        try:
            frame: facade.Frame = await asyncio.wrap_future(future)
        except asyncio.CancelledError:
            if future.cancelled() and not _cancelling():
                return False
            raise
        except Exception as failure:  # whatever a technique raises is told to its user; the view lives on
            if pane.state is task.state:
                pane.state = None
            for entry in said(failure):
                await self._tell(Refusal(**entry))
            return False
        seconds = time.perf_counter() - start
        self._hub.metrics.render.observe(seconds)
        self._controller.observe((seconds * 1e3 + self._encode_ms) * len(self.panes), task.scale)
        if task.coarse:
            self._coarse_s = seconds * len(self.panes)
            self._hub.movers.note(self, time.monotonic())
        elif self._hub.movers.others(self, time.monotonic()):
            self._pause_until = time.monotonic() + COURTESY * seconds
        pane.frame, pane.drawn = frame, task.key
        return True

    def _deliver(self, task: Task, frame: facade.Frame, codec: Codec, quality: int) -> None:
        """Encode and send a picture beside the drawing of the next one, in order."""
        if not task.overtaken:
            task.pane.shown, task.pane.sent = task.target, frame.samples
        self._sequence += 1
        self._unacknowledged.add(self._sequence)
        previous, sequence = self._delivery, self._sequence

        async def deliver() -> None:
            loop = asyncio.get_running_loop()
            image, encode_ms = await loop.run_in_executor(self._hub.encoders, encode, frame.rgb8, codec, quality)
            header = FrameHeader(
                sequence=sequence,
                version=task.target[0],
                stream=task.pane.index,
                width=frame.width,
                height=frame.height,
                codec=codec,
                samples=frame.samples,
                target_samples=frame.target_samples,
                converged=frame.converged,
                scale=task.scale,
                render_ms=frame.render_ms,
                encode_ms=encode_ms,
                technique=frame.technique,
            )
            if previous is not None:
                await previous
            await self._send(pack(header, image))
            self._last_sent = sequence
            self._hub.metrics.frames.inc()
            self._hub.metrics.frame_bytes.inc(len(image))
            if codec == "jpeg":
                self._encode_ms = encode_ms

        self._delivery = asyncio.create_task(deliver())
        self._deliveries.add(self._delivery)
        self._delivery.add_done_callback(self._delivered)

    def _delivered(self, delivery: asyncio.Task[None]) -> None:
        """A delivery that failed means that the client left, which its reader sees."""
        self._deliveries.discard(delivery)
        if not delivery.cancelled() and delivery.exception() is not None:
            log.debug("a frame was not delivered: %s", delivery.exception())


def _cancelling() -> bool:
    task = asyncio.current_task()
    return task is not None and task.cancelling() > 0
