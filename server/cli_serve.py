"""Commands about the server and the machine: serve, doctor."""

from __future__ import annotations

import argparse
import platform
import shutil
import signal
import sys
from importlib.metadata import version
from typing import Any

import uvicorn

from renderer.core.cache import default_folder
from renderer.core.errors import GLUnavailable
from renderer.session import Session
from server.app import WEB, create_app
from server.settings import Settings, load
from server.sockets import FairProtocol, bind

GRACE_S = 5
"""How long open requests may take to end once the server is asked to stop."""

SWITCH_S = 0.0005
"""How long a thread of Python may keep the others waiting: between drawing, encoding and sending a picture there are
five changes of thread, and Python's own 5 ms for each would be as long as the picture."""


def add(commands: Any) -> None:
    """Declare the commands."""
    serving = commands.add_parser("serve", help="serve the page and the HTTP interface")
    serving.add_argument("--host", help="address to bind to; another than this machine's own needs a token")
    serving.add_argument("--port", type=int, help="TCP port; 0 for any free one")
    serving.add_argument("--token", help="secret that clients must show; one is made where it is needed")
    serving.set_defaults(run=serve)
    checking = commands.add_parser("doctor", help="what this machine has and lacks")
    checking.set_defaults(run=doctor)


def configure(app: Any, settings: Settings) -> uvicorn.Config:
    """How uvicorn runs the server.

    Frames are compressed already, so messages are not; a message larger than the limit ends its connection.
    """
    return uvicorn.Config(
        app,
        host=settings.host,
        port=settings.port,
        ws=FairProtocol,
        ws_max_size=settings.message_bytes,
        ws_per_message_deflate=False,
        access_log=False,
        log_level="warning",
        server_header=False,
        timeout_graceful_shutdown=GRACE_S,
    )


def share_fairly() -> None:
    """Let the threads of this process take turns as often as a server of pictures needs."""
    sys.setswitchinterval(SWITCH_S)


def address(settings: Settings, port: int) -> str:
    """The page's address, as a person types it."""
    host = "127.0.0.1" if settings.host in ("0.0.0.0", "::") else settings.host
    shown = f"[{host}]" if ":" in host else host
    return f"http://{shown}:{port}/" + (f"?token={settings.token}" if settings.token else "")


def serve(given: argparse.Namespace) -> int:
    """Serve until interrupted."""
    settings = load(host=given.host, port=given.port, token=given.token).secured()
    with bind(settings) as listener, Session() as session:
        config = configure(create_app(session, settings, warm=True), settings)
        share_fairly()
        info = session.gl.info
        print(f"Umbrage draws with {info.renderer}{' (software)' if info.software else ''}.")
        print(f"Open {address(settings, listener.getsockname()[1])}", flush=True)
        # uvicorn ends gracefully and then raises the signal again, whose default would skip the closing of the session.
        signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
        uvicorn.Server(config).run(sockets=[listener])
    return 0


def doctor(given: argparse.Namespace) -> int:
    """Check what the server needs of the machine."""
    good = True
    print(f"umbrage  {version('umbrage')}")
    print(f"python   {platform.python_version()} ({sys.executable})")
    try:
        with Session() as session:
            info = session.gl.info
            kind = "software" if info.software else "hardware"
            print(f"opengl   {info.version[0]}.{info.version[1]} {info.renderer} ({kind})")
            print(f"scenes   {', '.join(scene['name'] for scene in session.scenes())}")
    except GLUnavailable as failure:
        good = False
        print(f"opengl   missing: {failure}")
    folder = default_folder()
    near = next(path for path in (folder, *folder.parents) if path.is_dir())
    print(f"cache    {folder}, {shutil.disk_usage(near).free >> 20} MiB free")
    page = (WEB / "index.html").is_file()
    print(f"page     {WEB if page else 'missing'}")
    return 0 if good and page else 1
