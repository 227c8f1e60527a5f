"""What the doors cost: encoding, the way from a pointer to the picture in a browser, and four sessions at once."""

from __future__ import annotations

import contextlib
import json
import multiprocessing
import os
import shutil
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from typing import Any

import numpy as np
import uvicorn
from websockets.sync.client import ClientConnection, connect

from server.app import create_app
from server.cli_serve import configure, share_fairly
from server.encode import MOVING_QUALITY, RESTING_QUALITY, encode
from server.facade import RenderSession
from server.protocol import unpack
from server.settings import Settings
from server.sockets import bind

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
REPEATS = 20
QUIET_S = 0.7
"""Pause between two moves on a quiet page: longer than refinement of a draft picture and its lossless end."""

DRAG_HZ = 60.0
VIEW = {"width": 512, "height": 512}
PATIENCE_S = 120.0

WATCH = """() => {
  window.seen = [];
  umbrage.stats.addEventListener("frame", () => {
    const last = umbrage.stats.last;
    window.seen.push({ latency: last.latency, render: last.render_ms, encode: last.encode_ms, decode: last.decode,
      scale: last.scale, bytes: last.bytes, codec: last.codec, at: last.at });
  });
}"""
"""Has the page note what every picture cost."""


def encoding(rgb8: np.ndarray) -> list[dict[str, Any]]:
    """Time and size of a picture in every form that frames take, medians of `REPEATS`."""
    found = []
    for codec, quality, when in (
        ("jpeg", MOVING_QUALITY, "moving"),
        ("jpeg", RESTING_QUALITY, "refining"),
        ("png", 0, "at rest"),
    ):
        made = [encode(rgb8, codec, quality) for _ in range(REPEATS)]  # type: ignore[arg-type]
        found.append(
            {
                "when": when,
                "codec": codec,
                "quality": quality,
                "size": [rgb8.shape[1], rgb8.shape[0]],
                "encode_ms": float(np.median([ms for _, ms in made])),
                "bytes": len(made[0][0]),
            }
        )
    return found


def small_jpeg(rgb8: np.ndarray, limit: int) -> bytes:
    """A picture as a JPEG of at most `limit` bytes, at quality 85 where that is small enough."""
    for quality in range(85, 20, -5):
        data = encode(rgb8, "jpeg", quality)[0]
        if len(data) <= limit:
            break
    return data


@contextlib.contextmanager
def serving(session: RenderSession) -> Iterator[str]:
    """A server of this session on a free port, by its address, until the end."""
    settings = Settings(port=0)
    listener = bind(settings)
    share_fairly()
    server = uvicorn.Server(configure(create_app(session, settings), settings))
    thread = threading.Thread(target=lambda: server.run(sockets=[listener]), name="bench")
    thread.start()
    try:
        _wait(lambda: server.started, "the server to start")
        yield f"127.0.0.1:{listener.getsockname()[1]}"
    finally:
        server.should_exit = True
        thread.join()
        listener.close()


def browser(address: str, seconds: float = 5.0, moves: int = 30) -> dict[str, Any]:
    """`in_browser`, from a process of its own: what drives the browser must not share the server's interpreter."""
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as apart:
        return apart.submit(in_browser, address, seconds, moves).result()


def in_browser(address: str, seconds: float, moves: int) -> dict[str, Any]:
    """Latency of single pointer moves on a quiet page, and pictures a second while dragging, in headless Chromium.

    Args:
        address: host and port of the server.
        seconds: of dragging.
        moves: single moves.

    Returns:
        Medians in ms over the moves: `latency_ms` from the pointer's handler to the completed draw on the canvas,
        `render_ms` of the pictures that answered, and `excess_ms` of one over the other; `pictures_per_second` while
        dragging, with the median linear `scale` and `bytes` of a picture. Without a browser, `missing` says why.
    """
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        return {"missing": "playwright is not installed: it comes with what the tests need"}
    path = next((found for name in BROWSERS if (found := shutil.which(name))), None)
    with sync_playwright() as playwright:
        # a container runs this as root, where Chromium's sandbox refuses to start
        arguments = ["--no-sandbox"] if os.geteuid() == 0 else []
        try:
            opened = playwright.chromium.launch(executable_path=path, args=arguments)
        except Exception as failure:  # playwright names no narrower one
            return {"missing": f"no browser starts here: {str(failure).splitlines()[0]}"}
        try:
            page = opened.new_page(viewport={"width": VIEW["width"], "height": VIEW["height"]})
            page.goto(f"http://{address}/")
            _wait(lambda: page.evaluate("window.umbrage !== undefined && umbrage.stats.frames > 0"), "a picture")
            # a draft at rest: nothing but the answer to the pointer is drawn
            page.evaluate("umbrage.store.change({quality: {kind: 'draft'}}, 'quality')")
            _quiet(page)
            page.evaluate(WATCH)
            single, dragged = _single(page, moves), _drag(page, seconds)
            return {**single, **dragged, "size": page.evaluate("[umbrage.screen.width, umbrage.screen.height]")}
        finally:
            opened.close()


def _single(page: Any, moves: int) -> dict[str, Any]:
    """Moves of a held pointer, each on a page that has come to rest."""
    x, y = VIEW["width"] / 2, VIEW["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 10, y)
    answers = []
    for number in range(moves):
        time.sleep(QUIET_S)
        before = page.evaluate("window.seen.length")
        page.mouse.move(x + 20 + 2 * number, y)
        _wait(lambda n=before: page.evaluate(f"window.seen.slice({n}).some((f) => f.latency !== null)"), "an answer")
        answers.append(page.evaluate(f"window.seen.slice({before}).find((f) => f.latency !== null)"))
    page.mouse.up()
    _quiet(page)
    excess = [answer["latency"] - answer["render"] for answer in answers]
    return {
        "moves": moves,
        "latency_ms": float(np.median([answer["latency"] for answer in answers])),
        "latency_p95_ms": float(np.percentile([answer["latency"] for answer in answers], 95)),
        "render_ms": float(np.median([answer["render"] for answer in answers])),
        "encode_ms": float(np.median([answer["encode"] for answer in answers])),
        "decode_ms": float(np.median([answer["decode"] for answer in answers])),
        "excess_ms": float(np.median(excess)),
        "single_scale": float(np.median([answer["scale"] for answer in answers])),
    }


def _drag(page: Any, seconds: float) -> dict[str, Any]:
    """A pointer that moves all the time."""
    x, y = VIEW["width"] / 2, VIEW["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    first, start = page.evaluate("window.seen.length"), time.monotonic()
    step = 0
    while time.monotonic() - start < seconds:
        step += 1
        page.mouse.move(x + 150 * np.sin(step / 40), y + 40 * np.sin(step / 25))
        time.sleep(max(0.0, start + step / DRAG_HZ - time.monotonic()))
    seen = page.evaluate(f"window.seen.slice({first})")
    page.mouse.up()
    settled = [frame for frame in seen if frame["at"] > seen[0]["at"] + 1000]  # the first second finds the resolution
    span = (settled[-1]["at"] - settled[0]["at"]) / 1e3
    return {
        "drag_seconds": seconds,
        "pictures_per_second": (len(settled) - 1) / span,
        "scale": float(np.median([frame["scale"] for frame in settled])),
        "lowest_scale": min(frame["scale"] for frame in settled),
        "bytes": float(np.median([frame["bytes"] for frame in settled])),
        "drag_render_ms": float(np.median([frame["render"] for frame in settled])),
        "drag_encode_ms": float(np.median([frame["encode"] for frame in settled])),
    }


def _quiet(page: Any) -> None:
    expression = "!umbrage.link.pending && umbrage.link.sent.length === 0 && umbrage.stats.idle"
    _wait(lambda: page.evaluate(expression), "the page to come to rest")


def several(address: str, document: dict[str, Any], count: int = 4, seconds: float = 6.0) -> dict[str, Any]:
    """Several sessions that all turn their own camera.

    Returns:
        `pictures_per_second` and the longest gap between two pictures, `longest_wait_ms`, of each.
    """
    times: list[list[float]] = [[] for _ in range(count)]
    begin = threading.Barrier(count)
    threads = [
        threading.Thread(target=_turn, args=(address, document, number, begin, seconds, times[number]))
        for number in range(count)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return {
        "sessions": count,
        "pictures_per_second": [(len(at) - 1) / (at[-1] - at[0]) for at in times],
        "longest_wait_ms": [float(np.diff(at).max() * 1e3) for at in times],
    }


def _turn(
    address: str, document: dict[str, Any], number: int, begin: threading.Barrier, seconds: float, times: list[float]
) -> None:
    """One session: each picture that comes is answered by the next turn of the camera, as a dragged pointer does."""
    azimuth = 90.0 * number
    with connect(f"ws://{address}/api/session", compression=None, max_size=None) as socket:
        hello = {"type": "hello", "protocol": 1, "state": _turned(document, azimuth), "codecs": ["jpeg", "png"], **VIEW}
        socket.send(json.dumps(hello))
        _frame(socket)
        begin.wait(PATIENCE_S)
        socket.send(json.dumps({"type": "moving", "active": True}))
        start = time.monotonic()
        step = 0
        while time.monotonic() - start < seconds:
            step += 1
            patch = {"camera": {"azimuth": (azimuth + 0.5 * step) % 360.0}}
            socket.send(json.dumps({"type": "patch", "patch": patch, "id": step}))
            _frame(socket)
            # the first second finds the resolution that holds the frame time
            if time.monotonic() - start > 1.0:
                times.append(time.monotonic())


def _turned(document: dict[str, Any], azimuth: float) -> dict[str, Any]:
    return {**document, "camera": {**document["camera"], "azimuth": azimuth}, "quality": {"kind": "draft"}}


def _frame(socket: ClientConnection) -> None:
    """Wait for the next picture and acknowledge it."""
    while True:
        message = socket.recv(PATIENCE_S)
        if isinstance(message, bytes):
            socket.send(json.dumps({"type": "ack", "sequence": unpack(message)[0].sequence}))
            return


def _wait(condition: Any, what: str) -> None:
    end = time.monotonic() + PATIENCE_S
    while not condition():
        if time.monotonic() > end:
            raise TimeoutError(f"waited {PATIENCE_S:.0f} s for {what}")
        time.sleep(0.01)
