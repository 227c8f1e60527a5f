"""Is the server alive, and on what does it draw."""

from __future__ import annotations

from importlib.metadata import version
from typing import Any

from fastapi import APIRouter
from starlette.responses import Response

from server.hub import TheHub

router = APIRouter(tags=["service"])


@router.get("/api/health", summary="State of the server")
async def health(hub: TheHub) -> dict[str, Any]:
    """Version, graphics and load of the server; needs no token."""
    info = hub.session.gl.info
    return {
        "status": "ok",
        "version": version("umbrage"),
        "gl": {"renderer": info.renderer, "version": list(info.version), "software": info.software},
        "sessions": len(hub.streams),
        "jobs": hub.jobs.unfinished(),
    }


@router.get("/metrics", summary="Counters for Prometheus", response_class=Response)
async def metrics(hub: TheHub) -> Response:
    """Counters in the text format of Prometheus."""
    return Response(hub.metrics.text(), media_type="text/plain; version=0.0.4; charset=utf-8")
