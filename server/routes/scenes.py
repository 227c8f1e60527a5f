"""What can be drawn: scenes, their schema and presets, and a small picture of each preset."""

from __future__ import annotations

import asyncio
import hashlib
import json
from typing import Any

from fastapi import APIRouter, Path, Request
from starlette.responses import Response

from renderer.core.params import merge
from server.hub import Hub, TheHub
from server.problems import Json, missing
from server.protocol import message_schema
from server.rendering import draw

router = APIRouter(tags=["scenes"])
THUMBNAIL = (320, 200)
THUMBNAIL_QUALITY = {"kind": "samples", "n": 8}


@router.get("/api/scenes", summary="List of scenes")
async def scenes(hub: TheHub) -> Response:
    """Every scene with its presets."""
    return Json(await hub.call(hub.session.scenes))


@router.get("/api/scenes/{scene}", summary="One scene", responses={404: {"description": "There is no such scene"}})
async def scene(hub: TheHub, scene: str = Path(max_length=100)) -> Response:
    """Schema of the state, its defaults, presets, slots and techniques."""
    with missing():
        return Json(await hub.call(hub.session.describe, scene))


@router.get(
    "/api/scenes/{scene}/presets/{preset}/thumbnail.jpg",
    summary="Small picture of a preset",
    response_class=Response,
    responses={200: {"content": {"image/jpeg": {}}}, 404: {"description": "There is no such preset"}},
)
async def thumbnail(
    request: Request, hub: TheHub, scene: str = Path(max_length=100), preset: str = Path(max_length=100)
) -> Response:
    """The preset drawn at 320 x 200, drawn once and kept by what it shows."""
    with missing():
        state = await hub.call(hub.session.state, scene, preset)
    document = merge(state.model_dump(mode="json"), {"quality": THUMBNAIL_QUALITY})
    tag = hashlib.sha256(json.dumps(document, sort_keys=True).encode()).hexdigest()[:32]
    headers = {"ETag": f'"{tag}"', "Cache-Control": "no-cache"}
    if f'"{tag}"' in request.headers.get("if-none-match", ""):
        return Response(status_code=304, headers=headers)
    image = await _thumbnail(hub, request, tag, document)
    return Response(image, media_type="image/jpeg", headers=headers)


async def _thumbnail(hub: Hub, request: Request, tag: str, document: dict[str, Any]) -> bytes:
    """One drawing a preset, however many ask for it at once."""
    async with hub.thumbnail_locks.setdefault(tag, asyncio.Lock()):
        if tag not in hub.thumbnails:
            picture = await draw(hub, request, hub.session.validate(document), *THUMBNAIL)
            hub.thumbnails[tag] = await hub.call(picture.encode, "jpeg")
    return hub.thumbnails[tag]


@router.get("/api/schema", summary="Schema of the WebSocket's messages and of every state")
async def schema(hub: TheHub) -> Response:
    """JSON schema of the messages of `/api/session`, which OpenAPI cannot list, and of each scene's state."""
    found = message_schema()
    found["states"] = {
        entry["name"]: (await hub.call(hub.session.describe, entry["name"]))["schema"]
        for entry in await hub.call(hub.session.scenes)
    }
    return Json(found)


@router.get(
    "/api/scenes/{scene}/presets/{preset}",
    summary="State document of a preset",
    responses={404: {"description": "There is no such preset"}},
)
async def preset(hub: TheHub, scene: str = Path(max_length=100), preset: str = Path(max_length=100)) -> Response:
    """The whole state document of a preset, as `POST /api/render` takes it."""
    with missing():
        return Json((await hub.call(hub.session.state, scene, preset)).model_dump(mode="json"))
