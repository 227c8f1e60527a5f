"""What the doors ask of a rendering session.

`renderer.session.Session` fulfils it; tests fulfil it with a double that fails on purpose.
"""

# ruff: noqa: D102 - the facade documents its own methods
from __future__ import annotations

from collections.abc import Callable, Mapping
from concurrent.futures import Future
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from pydantic import BaseModel


class Advance(Protocol):
    """How far long work has come."""

    @property
    def name(self) -> str: ...
    @property
    def fraction(self) -> float: ...
    @property
    def words(self) -> str: ...
    @property
    def seconds_left(self) -> float | None: ...


OnProgress = Callable[[Any], None]
"""Receives an `Advance`; called from any thread. It may raise `Cancelled` to stop the work."""


class Preparation(Protocol):
    """Precomputation under way; cancelling drops this holder's interest only."""

    @property
    def future(self) -> Future[None]: ...
    def cancel(self) -> None: ...


class Frame(Protocol):
    """One displayed picture of a view: rgb8 (H, W, 3) uint8, row 0 at the top."""

    rgb8: np.ndarray
    width: int
    height: int
    samples: int
    target_samples: int
    converged: bool
    render_ms: float
    technique: str


class View(Protocol):
    """One canvas: a running mean over the samples of one state at one size."""

    def frame(self, state: Any, width: int, height: int, more: int = 1) -> Future[Any]: ...
    def probe(self, state: Any, x: float, y: float) -> Future[dict[str, Any]]: ...
    def close(self) -> None: ...


class Picture(Protocol):
    """A finished picture."""

    linear: np.ndarray
    rgb8: np.ndarray
    samples: int
    render_ms: float
    meta: dict[str, Any]

    def encode(self, format: str) -> bytes: ...  # noqa: A002 - the facade's own word


class Comparison(Protocol):
    """A technique against the reference: pictures as PNG bytes by file name, and the numbers."""

    files: Mapping[str, bytes]
    numbers: Mapping[str, Any]


class Measurement(Protocol):
    """A measured quantity: arrays by name, and what was measured (units, technique, estimated error)."""

    arrays: Mapping[str, np.ndarray]
    meta: Mapping[str, Any]


class RenderSession(Protocol):
    """One per process."""

    @property
    def gl(self) -> Any: ...
    @property
    def assets(self) -> Any: ...
    def scenes(self) -> list[dict[str, Any]]: ...
    def describe(self, scene: str) -> dict[str, Any]: ...
    def state(
        self,
        scene: str,
        preset: str | None = None,
        sets: Mapping[str, Any] | None = None,
        document: dict[str, Any] | None = None,
    ) -> BaseModel: ...
    def validate(self, document: dict[str, Any]) -> BaseModel: ...
    def prepared(self, state: Any) -> bool: ...
    def expected_seconds(self, state: Any) -> float: ...
    def prepare(self, state: Any, on_progress: OnProgress | None = None) -> Preparation: ...
    def render(self, state: Any, width: int, height: int, on_progress: OnProgress | None = None) -> Picture: ...
    def compare(self, state: Any, width: int, height: int, on_progress: OnProgress | None = None) -> Comparison: ...
    def add_asset(self, path: Path, filename: str) -> dict[str, Any]: ...
    def quantities(self) -> list[dict[str, Any]]: ...
    def measure(
        self, quantity: str, arguments: Mapping[str, Any], files: Mapping[str, Path] | None = None
    ) -> Measurement: ...
    def view(self) -> View: ...
    def close(self) -> None: ...
