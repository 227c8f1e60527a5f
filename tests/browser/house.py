"""A real server for the browser, and what the tests and the screenshots ask of a page."""

from __future__ import annotations

import base64
import contextlib
import json
import os
import shutil
import socket
import tempfile
import threading
import time
import zlib
from collections.abc import Iterator
from typing import Any

import uvicorn
from playwright.sync_api import Browser, Page, Playwright

from renderer.core.baking import gather
from renderer.core.registry import phenomenon
from renderer.session import Session
from server.app import create_app
from server.settings import Settings

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
PATIENCE_S = 90.0
"""Longer than baking the default scene on two cores."""
POLL_S = 0.03


def launch(playwright: Playwright) -> Browser:
    """The system's Chromium, or playwright's own where there is none."""
    path = next((found for name in BROWSERS if (found := shutil.which(name))), None)
    # A container runs the tests as root, where Chromium's sandbox refuses to start.
    arguments = ["--no-sandbox"] if os.geteuid() == 0 else []
    return playwright.chromium.launch(executable_path=path, args=arguments)


def free_port() -> int:
    """A TCP port nobody uses."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


class Service:
    """The server on a port of its own, in a thread of this process.

    Args:
        session: outlives the service, so that a restart costs no precomputation.
        study: folder of a study's results.
    """

    def __init__(self, session: Session, study: str) -> None:
        self.session = session
        self.study = study
        self.port = free_port()
        self._server: uvicorn.Server | None = None
        self._thread: threading.Thread | None = None

    @property
    def address(self) -> str:
        """Where the page is."""
        return f"http://127.0.0.1:{self.port}/"

    def start(self) -> None:
        """Serve, and return once it answers."""
        app = create_app(self.session, Settings(port=self.port, study=self.study))
        config = uvicorn.Config(app, host="127.0.0.1", port=self.port, log_level="warning", timeout_graceful_shutdown=1)
        self._server = uvicorn.Server(config)
        self._thread = threading.Thread(target=self._server.run, name="service")
        self._thread.start()
        wait_for(lambda: self._server is not None and self._server.started, "the server to start")

    def stop(self) -> None:
        """Stop serving and join the thread."""
        if self._server is not None and self._thread is not None:
            self._server.should_exit = True
            self._thread.join()
        self._server = self._thread = None


@contextlib.contextmanager
def service() -> Iterator[Service]:
    """A server that is stopped, with its session, at the end; it has no study but the one that the project keeps.

    The default scene is baked here first: a worker process yields to whatever else computes, as other tests may.
    """
    with Session() as session, tempfile.TemporaryDirectory() as empty:
        for _ in gather(phenomenon("forest").bakes(session.state("forest")), session.cache):
            pass
        served = Service(session, empty)
        served.start()
        try:
            yield served
        finally:
            served.stop()


def wait_for(condition: Any, what: str, patience: float = PATIENCE_S) -> None:
    """Poll until `condition()` is true.

    Raises:
        TimeoutError: naming what was waited for.
    """
    end = time.monotonic() + patience
    while not condition():
        if time.monotonic() > end:
            raise TimeoutError(f"waited {patience:.0f} s for {what}")
        time.sleep(POLL_S)


def until(page: Page, expression: str, patience: float = PATIENCE_S) -> None:
    """Poll until a JavaScript expression is true in the page.

    Playwright's own polling evaluates text inside the page, which the page's policy forbids.
    """
    wait_for(lambda: page.evaluate(expression), expression, patience)


def link(address: str, document: dict[str, Any]) -> str:
    """The page's address of a state, packed as the page does it."""
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    packed = packer.compress(json.dumps(document).encode()) + packer.flush()
    return f"{address}#s={base64.urlsafe_b64encode(packed).decode().rstrip('=')}"


def state_of(page: Page) -> dict[str, Any]:
    """The document that the page shows."""
    found = page.evaluate("umbrage.store.document")
    assert isinstance(found, dict)
    return found


def settled(page: Page) -> None:
    """Wait until every change was accepted and its picture refined to the end."""
    until(page, "!umbrage.link.pending && umbrage.link.sent.length === 0 && umbrage.stats.idle")
