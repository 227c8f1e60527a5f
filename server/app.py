"""Assembles the server: session, guard, routes, page."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from importlib.metadata import version

from fastapi import FastAPI, WebSocket
from starlette.responses import Response
from starlette.staticfiles import StaticFiles
from starlette.types import Scope

from server import hub as hubs
from server import problems, stream
from server.facade import RenderSession
from server.guard import Guard
from server.hub import Hub
from server.rendering import warm_up
from server.routes import assets, docs, health, jobs, measure, outline, render, scenes, study
from server.settings import ROOT, Settings

WEB = ROOT / "web"


class Page(StaticFiles):
    """The page's files: always asked for again, answered by 304 while unchanged."""

    async def get_response(self, path: str, scope: Scope) -> Response:
        """A file, which its browser revalidates: an update of the server must reach an open page."""
        response = await super().get_response(path, scope)
        response.headers.setdefault("Cache-Control", "no-cache")
        return response


def create_app(session: RenderSession, settings: Settings, warm: bool = False) -> FastAPI:
    """The server's application.

    Args:
        session: what draws; the caller closes it after the server.
        settings: the operator's.
        warm: precompute and draw the first scene's default state at the start, before anybody asks.
    """

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        hub = Hub(session, settings)
        hubs.install(app, hub)
        warming = asyncio.create_task(warm_up(hub)) if warm else None
        yield
        if warming is not None:
            warming.cancel()
            await asyncio.gather(warming, return_exceptions=True)
        await hub.close()

    app = FastAPI(
        title="Umbrage",
        version=version("umbrage"),
        lifespan=lifespan,
        docs_url=None,
        redoc_url=None,
        description="Relights natural scenes in real time, and says how right each picture is. "
        "The messages of the WebSocket `/api/session` are described by `/api/schema`.",
    )
    problems.install(app)
    app.add_middleware(Guard, settings=settings)
    for resource in (health, scenes, render, outline, assets, jobs, measure, study, docs):
        app.include_router(resource.router)

    @app.websocket("/api/session")
    async def live(socket: WebSocket) -> None:
        await stream.serve(socket, hubs.hub_of(socket))

    app.mount("/", Page(directory=WEB, html=True, check_dir=False), name="page")
    return app
