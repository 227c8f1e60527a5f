"""One stream of pictures of a live view, and the next thing to do for it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from server import facade

Key = tuple[int, int, int]


@dataclass
class Pane:
    """One stream of pictures: 0 the state, 1 what it is compared with.

    Attributes:
        serial: number of the state shown, so that equal states share their samples.
        version: version of the document last accepted for it.
        drawn: serial, width and height of `frame`.
        shown: version and size of the last picture sent; `sent` its samples.
        final: version and size of the last lossless picture sent.
    """

    index: Literal[0, 1]
    view: facade.View
    state: Any = None
    serial: int = 0
    version: int = 0
    frame: facade.Frame | None = None
    drawn: Key | None = None
    shown: Key | None = None
    sent: int = 0
    final: Key | None = None

    def accept(self, state: Any, version: int) -> None:
        """Show a prepared state from now on."""
        if self.state is None or state != self.state:
            self.serial += 1
            if version == self.version:  # what stood for it so far was coarser
                self.shown = self.final = None
        self.state = state
        self.version = version


@dataclass(frozen=True)
class Task:
    """One thing to do for a pane, as things stood when it was chosen.

    Attributes:
        key: whose samples it adds to: serial of the state, width and height [px].
        target: what it shows: version of the document, width and height [px].
        coarse: it is one of a movement, or what is shown until the full picture is there.
    """

    pane: Pane
    state: Any
    scale: float
    key: Key
    target: Key
    coarse: bool

    @property
    def overtaken(self) -> bool:
        """Whether the state it shows stood for a finer one of the same version, which has come meanwhile."""
        return self.target[0] == self.pane.version and self.key[0] != self.pane.serial
